// The page's state as signals, and the wiring between the link and the picture.
import { computed, signal } from '@preact/signals';
import { command, type Command, type Refusal } from './api.ts';
import { t } from './i18n/index.ts';
import { Link, type SocketLike } from './link.ts';
import { applyMessage, type Model } from './model.ts';
import { parseFrame, parseMessage, type FrameMessage, type Overlay } from './proto.ts';

declare const BUILD_HASH: string;

export const model = signal<Model | null>(null);
/** wait: no word yet; live; dead: nothing for 3 s, or a connection that has not told everything yet. */
export const link = signal<'wait' | 'live' | 'dead'>('wait');
export const silentS = signal(0);
export const newVersion = signal(false);
export const overlay = signal<Overlay | null>(null);
export const pictureAgeS = signal(0);
export const simulated = signal(false);
export const videoRefused = signal<string | null>(null);
export const selected = signal<number | null>(null);
export const notice = signal<Refusal | null>(null);
export const live = computed(() => link.value === 'live');

/** Where frames are drawn; set by the live picture once it exists. Resolves when drawn. */
interface Screen {
  show(message: FrameMessage): Promise<boolean>;
  clearOverlay(): void;
  maxWidthPx(): number;
}
let screen: Screen | null = null;

const kMaxFps = 15;
const kQuality = 80;
const kTickMs = 250;

let connection: Link | null = null;
let serverAheadMs = 0;
let newestFrame = { id: -1, firstSeen: 0, exposedMs: 0, simulated: false };

export function connect(): void {
  const url = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`;
  connection = new Link(
    {
      connect: () => new WebSocket(url, 'cell.v1') as unknown as SocketLike,
      now: () => performance.now(),
      later: (callback, ms) => void setTimeout(callback, ms),
    },
    { opened: subscribe, text: received, binary: frameReceived, silent },
  );
  document.addEventListener('visibilitychange', subscribe);
  setInterval(tick, kTickMs);
}

export function attach(to: Screen | null): void {
  screen = to;
  subscribe();
}

/** Asks for what this page can show now: a hidden one takes no pictures. */
export function subscribe(): void {
  videoRefused.value = null;
  const video = screen && !document.hidden ? { cam: 0, maxW: screen.maxWidthPx(), maxFps: kMaxFps, quality: kQuality } : null;
  connection?.send({ type: 'sub', video, topics: ['log'] });
}

export async function run(name: Command): Promise<void> {
  notice.value = null;
  notice.value = await command(name, t('unreachable'));
}

function silent(): void {
  link.value = 'dead';
  overlay.value = null;
  selected.value = null;
  screen?.clearOverlay();
}

function received(data: string): void {
  const message = parseMessage(data);
  if (!message) return;
  if (message.type === 'hello') {
    newVersion.value = message.build !== BUILD_HASH;
    heardTime(message.serverTime);
  } else if (message.type === 'hb') {
    heardTime(message.t);
  } else if (message.type === 'video') {
    videoRefused.value = message.on ? null : message.why;
  } else {
    const next = applyMessage(model.value, message);
    if (next === 'resync') connection?.send({ type: 'resync' });
    else model.value = next;
    if (message.type === 'snap') link.value = 'live';
  }
}

async function frameReceived(data: ArrayBuffer): Promise<void> {
  const frame = parseFrame(data);
  if (!frame) return;
  if (await screen?.show(frame)) {
    if (frame.frameId !== newestFrame.id)
      newestFrame = { id: frame.frameId, firstSeen: performance.now(), exposedMs: frame.exposedMs, simulated: frame.simulated };
    simulated.value = frame.simulated;
    if (link.value !== 'dead') overlay.value = frame.overlay;
    else screen?.clearOverlay();
    tick();
  }
  connection?.send({ type: 'ack', f: frame.frameId });
}

function heardTime(serverUs: number): void {
  serverAheadMs = serverUs / 1000 - Date.now();
}

/** A simulated exposure carries simulated time: its age counts from when the page first saw it. */
function tick(): void {
  silentS.value = Math.floor((connection?.silentMs() ?? 0) / 1000);
  if (newestFrame.id < 0) return;
  const seen = performance.now() - newestFrame.firstSeen;
  const exposed = Date.now() + serverAheadMs - newestFrame.exposedMs;
  pictureAgeS.value = Math.max(0, newestFrame.simulated ? seen : Math.max(seen, exposed)) / 1000;
}
