// Press and hold: acts once after the time, never before, and not at all when let go, moved off or interrupted.

export const kHoldMs = 800;

export class Hold {
  private pressed = 0;
  private active = false;

  constructor(
    private readonly act: () => void,
    private readonly later: (callback: () => void, ms: number) => void,
    private readonly shown: (holding: boolean) => void,
  ) {}

  press(): void {
    if (this.active) return;
    this.active = true;
    const mine = ++this.pressed;
    this.shown(true);
    this.later(() => {
      if (!this.active || mine !== this.pressed) return;
      this.release();
      this.act();
    }, kHoldMs);
  }

  release(): void {
    if (!this.active) return;
    this.active = false;
    this.shown(false);
  }
}
