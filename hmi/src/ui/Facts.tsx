import { Sign } from './Sign.tsx';
import type { Row } from './Panel.tsx';

/** Names and values in two columns. */
export function Facts({ rows }: { rows: Row[] }) {
  return (
    <dl class="facts">
      {rows.map(({ label, value, odd, wide }) => (
        <div key={label} class={`${odd ? `odd p${odd}` : ''} ${wide ? 'wide' : ''}`}>
          <dt>{label}</dt>
          <dd>
            {odd ? <Sign priority={odd} /> : null} {value}
          </dd>
        </div>
      ))}
    </dl>
  );
}
