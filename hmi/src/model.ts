// What the page knows of the cell, and how a message changes it. Pure.
import type { Alarm, CellState, Counters, LogRow, Message } from './proto.ts';

export interface Model {
  state: CellState;
  recipe: string;
  counters: Counters;
  alarms: Alarm[];
  log: LogRow[];
  rev: { state: number; alarm: number };
}

const kLogKept = 200;

/** The model after the message; 'resync' when something was missed and everything must be asked for. */
export function applyMessage(model: Model | null, m: Message): Model | null | 'resync' {
  if (m.type === 'snap') {
    const { state, recipe, counters, alarms, log, rev } = m;
    return { state, recipe, counters, alarms: sorted(alarms), log, rev };
  }
  if (!model) return null;
  switch (m.type) {
    case 'state': {
      if (m.base !== model.rev.state) return 'resync';
      const { type: _type, rev, base: _base, recipe = model.recipe, counters = model.counters, ...changed } = m;
      return { ...model, recipe, counters, state: { ...model.state, ...changed }, rev: { ...model.rev, state: rev } };
    }
    case 'alarm': {
      if (m.rev !== model.rev.alarm + 1) return 'resync';
      const row = m.row;
      const others = model.alarms.filter((a) => a.id !== row.id);
      return { ...model, alarms: 'gone' in row ? others : sorted([...others, row]), rev: { ...model.rev, alarm: m.rev } };
    }
    case 'log': {
      const last = model.log[model.log.length - 1]?.n ?? 0;
      return { ...model, log: [...model.log, ...m.rows.filter((r) => r.n > last)].slice(-kLogKept) };
    }
    default:
      return model;
  }
}

/** Active before past, urgent before less urgent, new before old. */
function sorted(alarms: Alarm[]): Alarm[] {
  return [...alarms].sort(
    (a, b) => Number(b.active) - Number(a.active) || a.priority - b.priority || b.last_us - a.last_us || (a.id < b.id ? -1 : 1),
  );
}
