import type { ComponentChildren } from 'preact';

export function Panel({ title, name, aside, children }: { title: string; name: string; aside?: ComponentChildren; children: ComponentChildren }) {
  return (
    <section class={`panel ${name}`} aria-labelledby={`title-${name}`}>
      <div class="panel-head">
        <h2 id={`title-${name}`}>{title}</h2>
        {aside}
      </div>
      {children}
    </section>
  );
}

export interface Row {
  label: string;
  value: ComponentChildren;
  /** Differs from what is wanted: a sign and colour. */
  odd?: 1 | 2 | 3 | null;
  /** Takes the whole width where rows stand in two columns. */
  wide?: boolean;
}
