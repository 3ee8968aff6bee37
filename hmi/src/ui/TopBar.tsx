import { t } from '../i18n/index.ts';
import { link, live, model, pictureAgeS, run, silentS } from '../store.ts';
import { Button, HoldButton, NowButton } from './Button.tsx';
import { asPriority, Sign } from './Sign.tsx';

export function TopBar() {
  const m = model.value;
  const mode = m?.state.mode;
  const fault = mode === 'fault';
  return (
    <header class="top">
      <div class="who">
        <h1>{m?.state.cell || 'pickcell'}</h1>
        {m?.state.simulated ? <span class="tag">{t('simulation')}</span> : null}
      </div>
      <div class={`chip mode ${fault ? 'p1' : ''}`} data-mode={mode ?? ''}>
        <span class="chip-title">{mode ? t(`mode_${mode}`) : '–'}</span>
        <span class="chip-text">{m?.state.step || ' '}</span>
      </div>
      <RobotChip />
      <LinkChip />
      <AlarmChip />
      <div class="actions">
        <Button class="reset" disabled={!live.value || !fault} onPress={() => void run('reset')}>
          {t('reset')}
        </Button>
        <HoldButton class="start" hint={t('start_hold')} disabled={!live.value || mode !== 'idle'} onPress={() => void run('start')}>
          {t('start')}
        </HoldButton>
        <NowButton class="stop" onPress={() => void run('stop')}>
          {t('stop')}
        </NowButton>
      </div>
    </header>
  );
}

function RobotChip() {
  const robot = model.value?.state.robot;
  const bad = robot && (!robot.connected || robot.alarm);
  return (
    <div class={`chip robot-chip ${bad ? 'p1' : ''}`}>
      <span class="chip-title">{t('robot')}</span>
      <span class="chip-text">{!robot ? '–' : robot.connected ? robot.words : t('robot_off')}</span>
    </div>
  );
}

function LinkChip() {
  const state = link.value;
  const text = state === 'live' ? t('picture_age', { s: pictureAgeS.value.toFixed(1) }) : state === 'dead' ? `${silentS.value} s` : ' ';
  return (
    <div class={`chip link-chip ${state === 'dead' ? 'p1' : ''}`} data-link={state}>
      <span class="chip-title">{t(`link_${state}`)}</span>
      <span class="chip-text">{text}</span>
    </div>
  );
}

function AlarmChip() {
  const worst = model.value?.alarms.find((a) => a.active);
  const priority = worst ? asPriority(worst.priority) : null;
  return (
    <div class={`chip alarm-chip ${priority ? `p${priority}` : ''}`}>
      <span class="chip-title">
        {priority ? <Sign priority={priority} word /> : t('alarms_none')}
      </span>
      <span class="chip-text">{worst?.text ?? ' '}</span>
    </div>
  );
}
