// A colour never stands alone: each priority has its shape and its word.
import { t } from '../i18n/index.ts';

const kShapes = { 1: '■', 2: '▲', 3: '●' } as const;
export type Priority = keyof typeof kShapes;

export function asPriority(value: number): Priority {
  return value <= 1 ? 1 : value >= 3 ? 3 : 2;
}

export function Sign({ priority, word = false }: { priority: Priority; word?: boolean }) {
  return (
    <span class={`sign p${priority}`}>
      <span aria-hidden="true">{kShapes[priority]}</span>
      <span class={word ? 'sign-word' : 'unseen'}>{t(`priority_${priority}`)}</span>
    </span>
  );
}
