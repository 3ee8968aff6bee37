import { t } from '../i18n/index.ts';
import { link, model, newVersion, notice, silentS } from '../store.ts';
import { Button } from './Button.tsx';
import { Sign } from './Sign.tsx';

/** What needs to be read before anything else: a dead link, why the cell stopped, why a command was not done. */
export function Banners() {
  return (
    <div class="banners">
      <div role="alert">{link.value === 'dead' ? <DeadBanner /> : null}</div>
      <div role="status">{link.value === 'dead' ? null : <ReasonBanner />}</div>
      <div role="status">{newVersion.value ? <NewVersionBanner /> : null}</div>
      <div role="alert">{notice.value ? <NoticeBanner /> : null}</div>
    </div>
  );
}

function DeadBanner() {
  return (
    <div class="banner dead-banner p1">
      <Sign priority={1} />
      <p>
        <strong>{t('dead_title', { s: silentS.value })}</strong> {t('dead_text')}
      </p>
    </div>
  );
}

function ReasonBanner() {
  const state = model.value?.state;
  if (!state?.reason) return null;
  const fault = state.mode === 'fault';
  return (
    <div class={`banner ${fault ? 'p1' : ''}`}>
      {fault ? <Sign priority={1} /> : null}
      <p>
        <strong>{state.reason}</strong> {state.remedy}
      </p>
    </div>
  );
}

/** Never reloads by itself: a person may be in the middle of something. */
function NewVersionBanner() {
  return (
    <div class="banner">
      <p>{t('new_version')}</p>
      <Button class="reload" onPress={() => location.reload()}>
        {t('reload')}
      </Button>
    </div>
  );
}

function NoticeBanner() {
  const n = notice.value;
  if (!n) return null;
  return (
    <div class="banner notice p2">
      <Sign priority={2} />
      <p>
        <strong>
          {t('refused')}: {n.text}
        </strong>{' '}
        {n.remedies.join(' ')}
      </p>
      <Button onPress={() => (notice.value = null)}>{t('dismiss')}</Button>
    </div>
  );
}
