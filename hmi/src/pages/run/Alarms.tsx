import { t } from '../../i18n/index.ts';
import type { Alarm } from '../../proto.ts';
import { model } from '../../store.ts';
import { Panel } from '../../ui/Panel.tsx';
import { asPriority, Sign } from '../../ui/Sign.tsx';
import { clock } from '../../units.ts';

const kShown = 3;

export function Alarms() {
  const all = model.value?.alarms ?? [];
  const more = all.length - kShown;
  return (
    <Panel title={t('alarms')} name="alarms" aside={more > 0 ? <span class="aside">{t('alarms_more', { n: more })}</span> : null}>
      {all.length === 0 ? <p class="quiet">{t('alarms_none')}</p> : null}
      <ul class="alarm-list">
        {all.slice(0, kShown).map((a) => (
          <AlarmRow key={a.id} alarm={a} open={all.length === 1} />
        ))}
      </ul>
    </Panel>
  );
}

/** A single one says cause and remedy at once; of several each folds out. */
function AlarmRow({ alarm, open }: { alarm: Alarm; open: boolean }) {
  const priority = asPriority(alarm.priority);
  const when = alarm.count > 1 ? t('times', { n: alarm.count, t: clock(alarm.last_us) }) : t('since', { t: clock(alarm.first_us) });
  return (
    <li class={`alarm ${alarm.active ? `active p${priority}` : ''}`}>
      <details open={open}>
        <summary>
          {alarm.active ? <Sign priority={priority} word /> : <span class="past">{t('past')}</span>}
          <span class="alarm-text">{alarm.text}</span>
          <span class="when">{when}</span>
        </summary>
        {alarm.cause ? (
          <p>
            {t('cause')}: {alarm.cause}
          </p>
        ) : null}
        {alarm.remedies.length > 0 ? (
          <ol aria-label={t('remedy')}>
            {alarm.remedies.map((r) => (
              <li key={r}>{r}</li>
            ))}
          </ol>
        ) : null}
      </details>
    </li>
  );
}
