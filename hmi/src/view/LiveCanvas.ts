// Two canvases over each other: the picture and its overlay, drawn in one go, so that they always belong together.
import type { FrameMessage, Overlay } from '../proto.ts';
import { drawOverlay, type Point } from './overlay.ts';

export class LiveCanvas {
  private shown: Overlay | null = null;
  private size: Point | null = null;
  private selected: number | null = null;
  private newest = 0;

  constructor(
    private readonly frame: HTMLElement,
    private readonly stage: HTMLElement,
    private readonly picture: HTMLCanvasElement,
    private readonly overlay: HTMLCanvasElement,
  ) {}

  /** Decodes and draws. False when a newer one came meanwhile or the picture is damaged. */
  async show(message: FrameMessage): Promise<boolean> {
    const mine = ++this.newest;
    let bitmap: ImageBitmap;
    try {
      bitmap = await createImageBitmap(new Blob([message.jpeg], { type: 'image/jpeg' }));
    } catch {
      return false;
    }
    if (mine !== this.newest) {
      bitmap.close();
      return false;
    }
    if (this.picture.width !== bitmap.width || this.picture.height !== bitmap.height) {
      this.picture.width = bitmap.width;
      this.picture.height = bitmap.height;
    }
    this.picture.getContext('2d')?.drawImage(bitmap, 0, 0);
    bitmap.close();
    this.shown = message.overlay;
    this.size = [message.overlay.sw, message.overlay.sh];
    this.layout();
    return true;
  }

  select(id: number | null): void {
    if (this.selected === id) return;
    this.selected = id;
    this.redraw();
  }

  /** The picture stays as a memory, what was known about it goes. */
  clearOverlay(): void {
    ++this.newest;
    this.shown = null;
    this.redraw();
  }

  /** Fits the stage into its frame; to be called when the frame changes its size. */
  layout(): void {
    if (!this.size) return;
    const [w, h] = this.size;
    const scale = Math.min(this.frame.clientWidth / w, this.frame.clientHeight / h);
    this.stage.style.width = `${Math.floor(w * scale)}px`;
    this.stage.style.height = `${Math.floor(h * scale)}px`;
    this.redraw();
  }

  /** The sensor point under a place on the screen, and how many sensor pixels one CSS pixel is. */
  sensorPoint(clientX: number, clientY: number): { point: Point; perPx: number } | null {
    const box = this.stage.getBoundingClientRect();
    if (!this.size || box.width === 0) return null;
    const perPx = this.size[0] / box.width;
    return { point: [(clientX - box.left) * perPx - 0.5, (clientY - box.top) * perPx - 0.5], perPx };
  }

  current(): Overlay | null {
    return this.shown;
  }

  private redraw(): void {
    const ratio = window.devicePixelRatio || 1;
    const width = this.stage.clientWidth;
    const height = this.stage.clientHeight;
    const canvas = this.overlay;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const ctx = canvas.getContext('2d');
    if (!ctx) return;
    ctx.setTransform(1, 0, 0, 1, 0, 0);
    ctx.clearRect(0, 0, canvas.width, canvas.height);
    if (!this.shown || !this.size) return;
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawOverlay(ctx, this.shown, width / this.size[0], this.selected);
  }
}
