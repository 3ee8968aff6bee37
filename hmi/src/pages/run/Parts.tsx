import { t } from '../../i18n/index.ts';
import type { Det } from '../../proto.ts';
import { overlay, selected } from '../../store.ts';
import { Button } from '../../ui/Button.tsx';
import { Facts } from '../../ui/Facts.tsx';
import { Panel, type Row } from '../../ui/Panel.tsx';
import { Sign } from '../../ui/Sign.tsx';
import { deg, number } from '../../units.ts';

const isOdd = (d: Det): 2 | 3 | null => (d.st === 'missed' || d.st === 'unknown' ? 2 : d.st === 'rejected' ? 3 : null);

/** Every part in the picture as a button: what a tap on the picture does, for keyboards and small screens. */
export function Parts() {
  const dets = overlay.value?.dets ?? [];
  const chosen = selected.value;
  return (
    <Panel title={t('parts')} name="parts" aside={chosen === null ? null : <Button class="small" onPress={() => (selected.value = null)}>{t('part_close')}</Button>}>
      {chosen !== null ? (
        <Details det={dets.find((d) => d.id === chosen) ?? null} />
      ) : dets.length === 0 ? (
        <p class="quiet">{t('parts_none')}</p>
      ) : (
        <ul class="part-list">
          {dets.map((d) => (
            <li key={d.id}>
              <button type="button" class="part" onClick={() => (selected.value = d.id)}>
                <span class="part-name">{d.part}</span>
                <span class="part-score">{d.score.toFixed(2)}</span>
                <State det={d} />
              </button>
            </li>
          ))}
        </ul>
      )}
    </Panel>
  );
}

function State({ det }: { det: Det }) {
  const odd = isOdd(det);
  return (
    <span class={`part-state ${odd ? `odd p${odd}` : ''}`}>
      {odd ? <Sign priority={odd} /> : null} {t(`st_${det.st}`)}
    </span>
  );
}

function Details({ det }: { det: Det | null }) {
  if (!det) return <p class="quiet">{t('part_gone')}</p>;
  const rows: Row[] = [
    { label: t('part_score'), value: det.score.toFixed(3) },
    { label: t('part_place'), value: `${number(det.cx, 1)}, ${number(det.cy, 1)} px` },
    { label: t('part_angle'), value: deg(det.deg) },
    { label: t('part_scale'), value: det.sc.toFixed(3) },
  ];
  return (
    <div class="part-details" tabIndex={0} role="group" aria-label={det.part}>
      <div>
        <h3>
          {det.part} <span class="aside">#{det.id}</span>
        </h3>
        <State det={det} />
        {det.why ? (
          <p class="why">
            <strong>{t('part_why')}:</strong> {det.why}
          </p>
        ) : null}
      </div>
      <Facts rows={rows} />
    </div>
  );
}
