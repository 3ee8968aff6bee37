import { t } from '../../i18n/index.ts';
import { model } from '../../store.ts';
import { Facts } from '../../ui/Facts.tsx';
import { Panel } from '../../ui/Panel.tsx';
import { number } from '../../units.ts';

export function CountersPanel() {
  const c = model.value?.counters;
  if (!c) return <Panel title={t('counters')} name="counters">{null}</Panel>;
  const rejected = Object.entries(c.rejected).filter(([, n]) => n > 0).sort(([, a], [, b]) => b - a);
  const total = rejected.reduce((sum, [, n]) => sum + n, 0);
  return (
    <Panel title={t('counters')} name="counters" aside={<span class="aside">{t('recipe')}: {model.value?.recipe || '–'}</span>}>
      <div class="big">
        <p>
          <span class="big-number" data-counter="placed">{c.placed}</span> {t('placed')}
        </p>
        <p>
          <span class="big-number">{number(c.picks_per_min, 1)}</span> {t('per_min')}
        </p>
      </div>
      <Facts
        rows={[
          { label: t('submitted'), value: <span data-counter="submitted">{c.submitted}</span> },
          { label: t('missed'), value: <span data-counter="missed">{c.missed}</span>, odd: c.missed > 0 ? 3 : null },
          { label: t('unknown'), value: <span data-counter="unknown">{c.unknown}</span>, odd: c.unknown > 0 ? 2 : null },
          { label: t('found'), value: c.found },
          { label: t('frames'), value: c.frames },
          { label: t('rejected'), value: total },
          { label: t('match_time'), value: `${number(c.match_ms_median)} / ${number(c.match_ms_p95)} ms`, wide: true },
        ]}
      />
      {rejected.length > 0 ? (
        <ul class="bars" aria-label={t('rejected')}>
          {rejected.map(([reason, n]) => (
            <li key={reason}>
              <span class="bar-name">{reason}</span>
              <span class="bar-track" aria-hidden="true">
                <span class="bar-fill" style={{ width: `${(100 * n) / total}%` }} />
              </span>
              <span class="bar-value">{n}</span>
            </li>
          ))}
        </ul>
      ) : null}
    </Panel>
  );
}
