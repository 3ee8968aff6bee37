// Values for people: units beside them, fixed digits so that they do not jump, local time with the offset.

export const number = (v: number, digits = 0): string => v.toFixed(digits);
export const mm = (v: number): string => v.toFixed(1);
export const deg = (v: number): string => `${v.toFixed(1)}°`;

/** 14:03:07 of a UNIX time in microseconds. */
export function clock(us: number): string {
  const d = new Date(us / 1000);
  const two = (v: number): string => String(v).padStart(2, '0');
  return `${two(d.getHours())}:${two(d.getMinutes())}:${two(d.getSeconds())}`;
}

/** UTC+1 of this machine now. */
export function zone(at: Date = new Date()): string {
  const minutes = -at.getTimezoneOffset();
  const hours = Math.trunc(Math.abs(minutes) / 60);
  const rest = Math.abs(minutes) % 60;
  return `UTC${minutes < 0 ? '−' : '+'}${hours}${rest ? ':' + String(rest).padStart(2, '0') : ''}`;
}
