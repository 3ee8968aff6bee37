// The overlay's geometry and drawing. Sensor pixels have their centres at integers; the canvas has pixel edges at integers,
// so a sensor point p is drawn at (p + 0.5) * scale.
import type { Det, DetState, Overlay } from '../proto.ts';

export type Point = [number, number];

/** Corners of the part's template in sensor pixels, clockwise from its top left: c + s*R(a)*(t - ref), y down. */
export function corners(d: Det): [Point, Point, Point, Point] {
  const cos = Math.cos((d.deg * Math.PI) / 180) * d.sc;
  const sin = Math.sin((d.deg * Math.PI) / 180) * d.sc;
  const place = (x: number, y: number): Point => {
    const dx = x - d.rx;
    const dy = y - d.ry;
    return [d.cx + cos * dx + sin * dy, d.cy - sin * dx + cos * dy];
  };
  const right = d.w - 0.5;
  const bottom = d.h - 0.5;
  return [place(-0.5, -0.5), place(right, -0.5), place(right, bottom), place(-0.5, bottom)];
}

/** How far a sensor point lies outside the part's rectangle, in sensor pixels; 0 inside. */
export function distance(d: Det, [x, y]: Point): number {
  const rad = (d.deg * Math.PI) / 180;
  const dx = x - d.cx;
  const dy = y - d.cy;
  const tx = (Math.cos(rad) * dx - Math.sin(rad) * dy) / d.sc + d.rx;
  const ty = (Math.sin(rad) * dx + Math.cos(rad) * dy) / d.sc + d.ry;
  const out = (v: number, size: number): number => Math.max(-0.5 - v, 0, v - (size - 0.5));
  return Math.hypot(out(tx, d.w), out(ty, d.h)) * d.sc;
}

/** The part under a finger: the one whose centre is nearest among those within reach. */
export function partAt(overlay: Overlay, p: Point, reach: number): Det | null {
  const near = overlay.dets.filter((d) => distance(d, p) <= reach);
  const far = (d: Det): number => Math.hypot(d.cx - p[0], d.cy - p[1]);
  return near.reduce<Det | null>((best, d) => (!best || far(d) < far(best) ? d : best), null);
}

interface Style {
  colour: string;
  width: number;
  dash: number[];
  sign: string;
}

// On a grey picture white means normal; colour is for what went wrong, and each state has its own line and sign as well.
const kNormal = '#ffffff';
const kCaution = '#ffc069';
const kWrong = '#ff8f8f';
const kStyles: Record<DetState, Style> = {
  found: { colour: kNormal, width: 1.5, dash: [], sign: '' },
  queued: { colour: kNormal, width: 2.5, dash: [], sign: '' },
  picking: { colour: kNormal, width: 4, dash: [], sign: '▶ ' },
  placed: { colour: kNormal, width: 1.5, dash: [2, 4], sign: '✓ ' },
  rejected: { colour: kCaution, width: 2, dash: [7, 5], sign: '▲ ' },
  missed: { colour: kWrong, width: 2.5, dash: [], sign: '✕ ' },
  unknown: { colour: kWrong, width: 2.5, dash: [3, 3], sign: '? ' },
};

export function label(d: Det): string {
  return `${kStyles[d.st].sign}${d.part} ${d.score.toFixed(2)}`;
}

/** Draws into a context whose unit is one CSS pixel; scale: CSS pixels per sensor pixel. */
export function drawOverlay(ctx: CanvasRenderingContext2D, overlay: Overlay, scale: number, selected: number | null): void {
  const at = ([x, y]: Point): Point => [(x + 0.5) * scale, (y + 0.5) * scale];
  ctx.lineJoin = 'round';
  for (const d of overlay.dets) drawOutline(ctx, d, corners(d).map(at), d.id === selected);
  for (const d of overlay.dets) drawAxes(ctx, d, at, scale);
  for (const d of overlay.dets) drawLabel(ctx, d, corners(d).map(at), d.id === selected);
}

/** A light line on a dark one: readable on bright and on dark ground. */
function stroke(ctx: CanvasRenderingContext2D, style: Style): void {
  ctx.setLineDash([]);
  ctx.strokeStyle = 'rgba(10,12,14,0.75)';
  ctx.lineWidth = style.width + 2.5;
  ctx.stroke();
  ctx.setLineDash(style.dash);
  ctx.strokeStyle = style.colour;
  ctx.lineWidth = style.width;
  ctx.stroke();
  ctx.setLineDash([]);
}

function drawOutline(ctx: CanvasRenderingContext2D, d: Det, box: Point[], isSelected: boolean): void {
  const style = kStyles[d.st];
  ctx.beginPath();
  box.forEach(([x, y], i) => (i === 0 ? ctx.moveTo(x, y) : ctx.lineTo(x, y)));
  ctx.closePath();
  if (isSelected) {
    ctx.fillStyle = 'rgba(255,255,255,0.18)';
    ctx.fill();
  }
  stroke(ctx, isSelected ? { ...style, width: style.width + 1.5 } : style);
}

/** Centre, the direction of the template's x axis, and the grasp points. */
function drawAxes(ctx: CanvasRenderingContext2D, d: Det, at: (p: Point) => Point, scale: number): void {
  const style = kStyles[d.st];
  const [x, y] = at([d.cx, d.cy]);
  const rad = (d.deg * Math.PI) / 180;
  const length = Math.max(14, 0.3 * d.w * d.sc * scale);
  ctx.beginPath();
  ctx.moveTo(x, y);
  ctx.lineTo(x + Math.cos(rad) * length, y - Math.sin(rad) * length);
  ctx.moveTo(x - 5, y);
  ctx.lineTo(x + 5, y);
  ctx.moveTo(x, y - 5);
  ctx.lineTo(x, y + 5);
  stroke(ctx, { ...style, width: 1.5, dash: [] });
  for (const grip of d.grip) {
    const [gx, gy] = at(grip);
    ctx.beginPath();
    ctx.arc(gx, gy, 4, 0, 2 * Math.PI);
    stroke(ctx, { ...style, width: 1.5, dash: [] });
  }
}

function drawLabel(ctx: CanvasRenderingContext2D, d: Det, box: Point[], isSelected: boolean): void {
  const text = label(d);
  ctx.font = `${isSelected ? '600 ' : ''}13px system-ui, "Noto Sans", "Liberation Sans", sans-serif`;
  const width = ctx.measureText(text).width + 10;
  const bounds = ctx.getTransform();
  const right = ctx.canvas.width / bounds.a;
  const bottom = ctx.canvas.height / bounds.d;
  const left = Math.min(Math.max(0, Math.min(...box.map(([x]) => x))), right - width);
  const below = Math.max(...box.map(([, y]) => y)) + 4;
  const top = Math.max(0, below + 20 <= bottom ? below : Math.min(...box.map(([, y]) => y)) - 24);
  ctx.fillStyle = 'rgba(20,22,24,0.82)';
  ctx.fillRect(left, top, width, 20);
  ctx.fillStyle = kStyles[d.st].colour;
  ctx.textBaseline = 'middle';
  ctx.fillText(text, left + 5, top + 10.5);
}
