import { effect, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { t } from '../../i18n/index.ts';
import { attach, overlay, pictureAgeS, selected, simulated, videoRefused } from '../../store.ts';
import { Panel } from '../../ui/Panel.tsx';
import { number } from '../../units.ts';
import { LiveCanvas } from '../../view/LiveCanvas.ts';
import { partAt } from '../../view/overlay.ts';

const kFingerPx = 24;
const kSummaryMs = 2000;
const kMaxWidthPx = 1280;
const kOldS = 1;

export function LivePicture() {
  const frame = useRef<HTMLDivElement>(null);
  const stage = useRef<HTMLDivElement>(null);
  const picture = useRef<HTMLCanvasElement>(null);
  const drawn = useRef<HTMLCanvasElement>(null);
  const live = useRef<LiveCanvas | null>(null);
  const seen = useSignal(false);

  useEffect(() => {
    const canvas = new LiveCanvas(frame.current!, stage.current!, picture.current!, drawn.current!);
    live.current = canvas;
    const sizes = new ResizeObserver(() => canvas.layout());
    sizes.observe(frame.current!);
    attach({
      show: async (message) => {
        const done = await canvas.show(message);
        if (done) seen.value = true;
        return done;
      },
      clearOverlay: () => canvas.clearOverlay(),
      maxWidthPx: () => Math.min(kMaxWidthPx, Math.ceil(frame.current!.clientWidth * window.devicePixelRatio)),
    });
    const stopSelecting = effect(() => canvas.select(selected.value));
    return () => {
      stopSelecting();
      attach(null);
      sizes.disconnect();
    };
  }, []);

  const tap = (e: MouseEvent): void => {
    const at = live.current?.sensorPoint(e.clientX, e.clientY);
    const current = live.current?.current();
    if (at && current) selected.value = partAt(current, at.point, kFingerPx * at.perPx)?.id ?? null;
  };

  const shown = overlay.value;
  return (
    <Panel title={t('live')} name="live" aside={shown ? <span class="aside">#{shown.f} · {number(shown.ms.match)} ms</span> : null}>
      <div class="live-frame" ref={frame}>
        <div class={`stage ${seen.value ? '' : 'empty'}`} ref={stage} onClick={tap}>
          <canvas class="picture" ref={picture} role="img" aria-label={t('live')} />
          <canvas class="overlay" ref={drawn} aria-hidden="true" />
          {simulated.value ? <span class="tag on-picture">{t('simulation')}</span> : null}
          {seen.value && pictureAgeS.value > kOldS ? <span class="age">{t('age', { s: pictureAgeS.value.toFixed(1) })}</span> : null}
        </div>
        {seen.value ? null : <p class="quiet no-picture">{videoRefused.value ? t('live_busy') : t('live_none')}</p>}
      </div>
      <Summary />
    </Panel>
  );
}

/** The picture in words, spoken at most every two seconds. */
function Summary() {
  const text = useSignal('');
  useEffect(() => {
    const say = (): void => {
      const dets = overlay.value?.dets ?? [];
      text.value = overlay.value ? t('parts_summary', { n: dets.length, r: dets.filter((d) => d.st === 'rejected').length }) : '';
    };
    const timer = setInterval(say, kSummaryMs);
    return () => clearInterval(timer);
  }, []);
  return (
    <p class="unseen" aria-live="polite">
      {text.value}
    </p>
  );
}
