import { t } from '../i18n/index.ts';
import { link } from '../store.ts';
import { Banners } from '../ui/Banners.tsx';
import { TopBar } from '../ui/TopBar.tsx';
import { Alarms } from './run/Alarms.tsx';
import { CountersPanel } from './run/Counters.tsx';
import { LivePicture } from './run/LivePicture.tsx';
import { LogPanel } from './run/Log.tsx';
import { Parts } from './run/Parts.tsx';
import { RobotPanel } from './run/Robot.tsx';

export function Run() {
  return (
    <div class={`page ${link.value}`}>
      <TopBar />
      <Banners />
      <main class="run" aria-label={t('main')}>
        <div class="left">
          <LivePicture />
          <Parts />
        </div>
        <div class="right">
          <Alarms />
          <RobotPanel />
          <CountersPanel />
          <LogPanel />
        </div>
      </main>
      <footer>{t('no_estop')}</footer>
    </div>
  );
}
