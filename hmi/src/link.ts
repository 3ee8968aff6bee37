// The WebSocket: one connection, a watchdog that does not trust a silent one, and automatic return.
// Everything from outside is handed in, so that tests run it on a clock of their own.

export interface SocketLike {
  binaryType: string;
  onopen: (() => void) | null;
  onclose: (() => void) | null;
  onmessage: ((event: { data: unknown }) => void) | null;
  send(text: string): void;
  close(): void;
}

export interface Surroundings {
  connect(): SocketLike;
  now(): number;
  later(callback: () => void, ms: number): void;
}

export interface LinkEvents {
  /** A new connection: nothing of the old one counts any more. */
  opened(): void;
  text(data: string): void;
  binary(data: ArrayBuffer): void;
  /** Silent for too long. The next message ends it. */
  silent(): void;
}

/** The server beats each second; three missed beats are a dead link. A frozen server keeps its sockets open. */
export const kSilenceMs = 3000;
const kCheckMs = 250;
const kRetryMs = [500, 1000, 2000, 4000];

export class Link {
  private socket: SocketLike | null = null;
  private isOpen = false;
  private began = 0;
  private lastHeard: number;
  private toldSilent = false;
  private failures = 0;

  constructor(private readonly out: Surroundings, private readonly events: LinkEvents) {
    this.lastHeard = out.now();
    this.connect();
    this.watch();
  }

  /** For so long nothing was heard, milliseconds. */
  silentMs(): number {
    return this.out.now() - this.lastHeard;
  }

  /** Dropped when there is no connection: every connection begins with everything. */
  send(message: object): void {
    if (this.isOpen) this.socket?.send(JSON.stringify(message));
  }

  private connect(): void {
    const socket = this.out.connect();
    this.socket = socket;
    this.began = this.out.now();
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.isOpen = true;
      this.events.opened();
    };
    socket.onmessage = ({ data }) => {
      this.lastHeard = this.out.now();
      this.toldSilent = false;
      this.failures = 0;
      if (typeof data === 'string') this.events.text(data);
      else if (data instanceof ArrayBuffer) this.events.binary(data);
    };
    socket.onclose = () => this.retry();
  }

  private retry(): void {
    const old = this.socket;
    if (!old) return;
    this.socket = null;
    this.isOpen = false;
    old.onopen = old.onclose = old.onmessage = null;
    old.close();
    const wait = kRetryMs[Math.min(this.failures++, kRetryMs.length - 1)] ?? 0;
    this.out.later(() => this.connect(), wait);
  }

  private watch(): void {
    const now = this.out.now();
    if (now - this.lastHeard > kSilenceMs && !this.toldSilent) {
      this.toldSilent = true;
      this.events.silent();
    }
    if (this.socket && now - Math.max(this.lastHeard, this.began) > kSilenceMs) this.retry();
    this.out.later(() => this.watch(), kCheckMs);
  }
}
