import { Sign } from './Sign.tsx';
import type { Row } from './Panel.tsx';

/** Names and values in two columns. */
export function Facts({ rows }: { rows: Row[] }) {
  return (
    <dl class="facts">
      {rows.map(({ label, value, odd }) => (
        <div key={label} class={odd ? `odd p${odd}` : ''}>
          <dt>{label}</dt>
          <dd>
            {odd ? <Sign priority={odd} /> : null} {value}
          </dd>
        </div>
      ))}
    </dl>
  );
}
