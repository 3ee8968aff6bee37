import { t } from '../../i18n/index.ts';
import { model } from '../../store.ts';
import { Facts } from '../../ui/Facts.tsx';
import { Panel, type Row } from '../../ui/Panel.tsx';
import { mm } from '../../units.ts';

export function RobotPanel() {
  const state = model.value?.state;
  const robot = state?.robot;
  if (!robot) return <Panel title={t('robot')} name="robot">{null}</Panel>;
  const rows: Row[] = [
    { label: t('robot_link'), value: robot.connected ? t('robot_on') : t('robot_off'), odd: robot.connected ? null : 1 },
  ];
  if (robot.connected) {
    // Only what is not as it should be for picking carries a sign.
    rows.push(
      { label: t('robot_state'), value: robot.words, odd: null },
      { label: t('servo'), value: robot.servo ? t('on') : t('off'), odd: !robot.servo && state.mode === 'running' ? 2 : null },
      { label: t('remote'), value: robot.remote ? t('on') : t('off'), odd: robot.remote ? null : 2 },
      { label: t('robot_tool'), value: `${robot.tool_mm.map(mm).join('  ')} mm` },
    );
    if (robot.held) rows.push({ label: t('held'), value: t('yes'), odd: 2 });
    if (robot.teach) rows.push({ label: t('teach'), value: t('yes'), odd: 2 });
    if (robot.alarm) rows.push({ label: t('robot_alarm'), value: t('yes'), odd: 1 });
  }
  return (
    <Panel title={t('robot')} name="robot" aside={<span class="aside">{robot.link}</span>}>
      <Facts rows={rows} />
    </Panel>
  );
}
