import { t } from '../../i18n/index.ts';
import { model } from '../../store.ts';
import { Facts } from '../../ui/Facts.tsx';
import { Panel, type Row } from '../../ui/Panel.tsx';
import { mm } from '../../units.ts';

export function RobotPanel() {
  const state = model.value?.state;
  const robot = state?.robot;
  if (!robot) return <Panel title={t('robot')} name="robot">{null}</Panel>;
  const rows: Row[] = [];
  if (!robot.connected) {
    rows.push({ label: t('robot_link'), value: t('robot_off'), odd: 1 });
  } else {
    rows.push({ label: t('robot_state'), value: robot.words }, { label: t('robot_tool'), value: `${robot.tool_mm.map(mm).join('  ')} mm` });
    // Beyond that only what is not as picking needs it.
    if (robot.alarm) rows.push({ label: t('robot_alarm'), value: t('yes'), odd: 1 });
    if (robot.held) rows.push({ label: t('held'), value: t('yes'), odd: 2 });
    if (robot.teach) rows.push({ label: t('teach'), value: t('yes'), odd: 2 });
    if (!robot.remote) rows.push({ label: t('remote'), value: t('off'), odd: 2 });
    if (!robot.servo && state.mode === 'running') rows.push({ label: t('servo'), value: t('off'), odd: 2 });
  }
  return (
    <Panel title={t('robot')} name="robot" aside={<span class="aside">{robot.link}</span>}>
      <Facts rows={rows} />
    </Panel>
  );
}
