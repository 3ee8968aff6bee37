import { de } from './de.ts';
import { en, type Key } from './en.ts';

export type { Key };

/** ?lang=de, else the browser's language, else English. */
export function chooseLanguage(search: string, preferred: readonly string[]): 'en' | 'de' {
  const wish = new URLSearchParams(search).get('lang') ?? preferred[0] ?? 'en';
  return wish.toLowerCase().startsWith('de') ? 'de' : 'en';
}

let table: Record<Key, string> = en;

export function setLanguage(language: 'en' | 'de'): void {
  table = language === 'de' ? de : en;
}

/** The text, with {name} replaced. */
export function t(key: Key, values: Record<string, string | number> = {}): string {
  return table[key].replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ''));
}
