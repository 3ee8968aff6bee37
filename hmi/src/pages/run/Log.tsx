import { useLayoutEffect, useRef } from 'preact/hooks';
import { t, type Key } from '../../i18n/index.ts';
import type { LogRow } from '../../proto.ts';
import { model } from '../../store.ts';
import { Panel } from '../../ui/Panel.tsx';
import { Sign } from '../../ui/Sign.tsx';
import { clock, zone } from '../../units.ts';

export function LogPanel() {
  const rows = model.value?.log ?? [];
  const list = useRef<HTMLOListElement>(null);
  const atEnd = useRef(true);
  useLayoutEffect(() => {
    if (list.current && atEnd.current) list.current.scrollTop = list.current.scrollHeight;
  }, [rows]);
  const scrolled = (): void => {
    const l = list.current;
    if (l) atEnd.current = l.scrollHeight - l.scrollTop - l.clientHeight < 24;
  };
  return (
    <Panel title={t('log')} name="log" aside={<span class="aside">{zone()}</span>}>
      {rows.length === 0 ? <p class="quiet">{t('log_none')}</p> : null}
      <ol class="log-list" ref={list} tabIndex={0} aria-labelledby="title-log" onScroll={scrolled}>
        {rows.map((r) => (
          <Line key={r.n} row={r} />
        ))}
      </ol>
    </Panel>
  );
}

function Line({ row }: { row: LogRow }) {
  const priority = row.level === 'error' ? 1 : row.level === 'warning' ? 2 : null;
  const level = `level_${row.level}` as Key;
  return (
    <li class={priority ? `p${priority}` : ''}>
      <time>{clock(row.us)}</time>
      <span>
        {priority ? <Sign priority={priority} /> : null} <span class="unseen">{t(level)}</span>
        <span class="log-module">{row.module}</span> {row.text}
      </span>
    </li>
  );
}
