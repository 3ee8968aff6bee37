// What comes over the WebSocket: types and parsers. Nothing that arrives is trusted: what does not fit is null.

export type Mode = 'idle' | 'running' | 'stopping' | 'fault';
export type DetState = 'found' | 'queued' | 'picking' | 'placed' | 'missed' | 'unknown' | 'rejected';

export interface Det {
  id: number;
  part: string;
  /** Reference point in sensor pixels (centres at integers), degrees counter-clockwise on the screen, 1 = taught size. */
  cx: number;
  cy: number;
  deg: number;
  sc: number;
  /** Template size and reference point in it, pixels. */
  w: number;
  h: number;
  rx: number;
  ry: number;
  score: number;
  st: DetState;
  why: string | null;
  grip: [number, number][];
}

export interface Overlay {
  f: number;
  recipe: string;
  ms: { grab: number; match: number };
  /** Sensor size, pixels. */
  sw: number;
  sh: number;
  dets: Det[];
  more: number;
}

export interface FrameMessage {
  kind: number;
  camera: number;
  frameId: number;
  /** Mid-exposure, milliseconds since the UNIX epoch. */
  exposedMs: number;
  w: number;
  h: number;
  scale: number;
  simulated: boolean;
  overlayPending: boolean;
  overlay: Overlay;
  jpeg: Uint8Array<ArrayBuffer>;
}

export interface Robot {
  connected: boolean;
  link: string;
  words: string;
  running: boolean;
  servo: boolean;
  remote: boolean;
  held: boolean;
  alarm: boolean;
  teach: boolean;
  tool_mm: number[];
}

export interface Counters {
  frames: number;
  found: number;
  submitted: number;
  placed: number;
  missed: number;
  unknown: number;
  rejected: Record<string, number>;
  picks_per_min: number;
  match_ms_median: number;
  match_ms_p95: number;
}

export interface CellState {
  cell: string;
  mode: Mode;
  step: string;
  reason: string;
  remedy: string;
  simulated: boolean;
  robot: Robot;
}

export interface Alarm {
  id: string;
  code: string;
  priority: number;
  text: string;
  cause: string;
  remedies: string[];
  first_us: number;
  last_us: number;
  count: number;
  active: boolean;
}

export interface LogRow {
  n: number;
  us: number;
  level: string;
  module: string;
  text: string;
}

export type Message =
  | { type: 'hello'; proto: string; build: string; serverTime: number }
  | { type: 'snap'; rev: { state: number; alarm: number }; state: CellState; recipe: string; counters: Counters; alarms: Alarm[]; log: LogRow[] }
  | ({ type: 'state'; rev: number; base: number; recipe?: string; counters?: Counters } & Partial<CellState>)
  | { type: 'alarm'; rev: number; row: Alarm | { id: string; gone: true } }
  | { type: 'log'; rows: LogRow[] }
  | { type: 'video'; on: boolean; why: string }
  | { type: 'hb'; t: number };

const kMagic = 0x31464d56;
const kHeaderBytes = 32;
const kMaxSide = 16384;
const kMaxOverlayBytes = 1 << 20;
const kStates: readonly string[] = ['found', 'queued', 'picking', 'placed', 'missed', 'unknown', 'rejected'];
const kModes: readonly string[] = ['idle', 'running', 'stopping', 'fault'];

type Unknown = Record<string, unknown>;
const isObject = (v: unknown): v is Unknown => typeof v === 'object' && v !== null && !Array.isArray(v);
const isNumber = (v: unknown): v is number => typeof v === 'number' && Number.isFinite(v);
const isString = (v: unknown): v is string => typeof v === 'string';
const isBoolean = (v: unknown): v is boolean => typeof v === 'boolean';
const isList = <T>(v: unknown, item: (x: unknown) => x is T): v is T[] => Array.isArray(v) && v.every(item);
const has = (v: Unknown, test: (x: unknown) => boolean, ...keys: string[]): boolean => keys.every((k) => test(v[k]));

const isPoint = (v: unknown): v is [number, number] => isList(v, isNumber) && v.length === 2;

function isDet(v: unknown): v is Det {
  return (
    isObject(v) &&
    has(v, isNumber, 'id', 'cx', 'cy', 'deg', 'sc', 'w', 'h', 'rx', 'ry', 'score') &&
    isString(v.part) &&
    isString(v.st) &&
    kStates.includes(v.st) &&
    (v.why === null || isString(v.why)) &&
    isList(v.grip, isPoint)
  );
}

function overlayOf(text: string, frameId: number): Overlay | null {
  const v = json(text);
  if (!isObject(v) || v.f !== frameId || !isString(v.recipe) || !isObject(v.ms)) return null;
  if (!has(v.ms, isNumber, 'grab', 'match') || !has(v, isNumber, 'sw', 'sh') || !isList(v.dets, isDet)) return null;
  if ((v.sw as number) < 1 || (v.sh as number) < 1) return null;
  return { ...(v as unknown as Overlay), more: isNumber(v.more) ? v.more : 0 };
}

function json(text: string): unknown {
  try {
    return JSON.parse(text) as unknown;
  } catch {
    return undefined;
  }
}

/** One frame with its overlay, or null when the bytes are not one. The overlay must name the same frame as the header. */
export function parseFrame(buffer: ArrayBuffer): FrameMessage | null {
  if (buffer.byteLength < kHeaderBytes) return null;
  const v = new DataView(buffer);
  if (v.getUint32(0, true) !== kMagic || v.getUint8(4) !== 1) return null;
  const kind = v.getUint8(5);
  const jsonLength = v.getUint32(12, true);
  const w = v.getUint16(24, true);
  const h = v.getUint16(26, true);
  const scale = v.getUint16(28, true) / 1000;
  const jpegStart = kHeaderBytes + jsonLength;
  if (kind < 1 || kind > 4 || w < 1 || h < 1 || w > kMaxSide || h > kMaxSide || scale === 0) return null;
  if (jsonLength > kMaxOverlayBytes || jpegStart >= buffer.byteLength) return null;
  const frameId = v.getUint32(8, true);
  let text: string;
  try {
    text = new TextDecoder('utf-8', { fatal: true }).decode(new Uint8Array(buffer, kHeaderBytes, jsonLength));
  } catch {
    return null;
  }
  const overlay = overlayOf(text, frameId);
  if (!overlay) return null;
  const flags = v.getUint16(30, true);
  const exposedMs = (v.getUint32(16, true) + v.getUint32(20, true) * 2 ** 32) / 1000;
  return {
    kind, camera: v.getUint16(6, true), frameId, exposedMs, w, h, scale, overlay,
    simulated: (flags & 1) !== 0,
    overlayPending: (flags & 2) !== 0,
    jpeg: new Uint8Array(buffer, jpegStart),
  };
}

const isMode = (v: unknown): v is Mode => isString(v) && kModes.includes(v);

function isRobot(v: unknown): v is Robot {
  return (
    isObject(v) &&
    has(v, isBoolean, 'connected', 'running', 'servo', 'remote', 'held', 'alarm', 'teach') &&
    has(v, isString, 'link', 'words') &&
    isList(v.tool_mm, isNumber) &&
    v.tool_mm.length === 3
  );
}

function isCounters(v: unknown): v is Counters {
  return (
    isObject(v) &&
    has(v, isNumber, 'frames', 'found', 'submitted', 'placed', 'missed', 'unknown', 'picks_per_min', 'match_ms_median', 'match_ms_p95') &&
    isObject(v.rejected) &&
    Object.values(v.rejected).every(isNumber)
  );
}

function isState(v: unknown): v is CellState {
  return isObject(v) && has(v, isString, 'cell', 'step', 'reason', 'remedy') && isMode(v.mode) && isBoolean(v.simulated) && isRobot(v.robot);
}

function isAlarm(v: unknown): v is Alarm {
  return (
    isObject(v) &&
    has(v, isString, 'id', 'code', 'text', 'cause') &&
    has(v, isNumber, 'priority', 'first_us', 'last_us', 'count') &&
    isBoolean(v.active) &&
    isList(v.remedies, isString)
  );
}

const isLogRow = (v: unknown): v is LogRow => isObject(v) && has(v, isNumber, 'n', 'us') && has(v, isString, 'level', 'module', 'text');

/** Absent, or as expected. */
const optional = (v: unknown, test: (x: unknown) => boolean): boolean => v === undefined || test(v);

function isStateChange(v: Unknown): boolean {
  return (
    has(v, isNumber, 'rev', 'base') &&
    ['cell', 'step', 'reason', 'remedy', 'recipe'].every((k) => optional(v[k], isString)) &&
    optional(v.mode, isMode) &&
    optional(v.simulated, isBoolean) &&
    optional(v.robot, isRobot) &&
    optional(v.counters, isCounters)
  );
}

const kChecks: Record<string, (v: Unknown) => boolean> = {
  hello: (v) => has(v, isString, 'proto', 'build') && isNumber(v.serverTime),
  snap: (v) =>
    isObject(v.rev) && has(v.rev, isNumber, 'state', 'alarm') && isState(v.state) && isString(v.recipe) &&
    isCounters(v.counters) && isList(v.alarms, isAlarm) && isList(v.log, isLogRow),
  state: isStateChange,
  alarm: (v) => isNumber(v.rev) && (isAlarm(v.row) || (isObject(v.row) && isString(v.row.id) && v.row.gone === true)),
  log: (v) => isList(v.rows, isLogRow),
  video: (v) => isBoolean(v.on) && isString(v.why),
  hb: (v) => isNumber(v.t),
};

export function parseMessage(text: string): Message | null {
  const v = json(text);
  if (!isObject(v) || !isString(v.type) || !Object.prototype.hasOwnProperty.call(kChecks, v.type)) return null;
  return kChecks[v.type]!(v) ? (v as unknown as Message) : null;
}
