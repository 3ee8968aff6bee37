import type { ComponentChildren } from 'preact';
import { useMemo, useRef } from 'preact/hooks';
import { useSignal } from '@preact/signals';
import { Hold } from '../hold.ts';

interface Props {
  class?: string;
  disabled?: boolean;
  onPress: () => void;
  children: ComponentChildren;
}

/** Acts on the press itself, by pointer or key: for Stop, where every moment counts. */
export function NowButton({ onPress, disabled, children, ...rest }: Props) {
  const pressed = useRef(false);
  const press = (): void => {
    pressed.current = true;
    onPress();
  };
  // A click follows each press; one that follows none comes from assistive technology.
  const click = (): void => {
    if (!pressed.current) onPress();
    pressed.current = false;
  };
  return (
    <button
      type="button"
      class={`button ${rest.class ?? ''}`}
      disabled={disabled}
      onPointerDown={(e) => e.button === 0 && press()}
      onPointerLeave={() => (pressed.current = false)}
      onKeyDown={(e) => !e.repeat && (e.key === 'Enter' || e.key === ' ') && press()}
      onClick={click}
    >
      {children}
    </button>
  );
}

export function Button({ onPress, disabled, children, ...rest }: Props) {
  return (
    <button type="button" class={`button ${rest.class ?? ''}`} disabled={disabled} onClick={onPress}>
      {children}
    </button>
  );
}

/** Acts after 0.8 s of holding; letting go, moving off or losing the pointer calls it off. */
export function HoldButton({ onPress, disabled, hint, children, ...rest }: Props & { hint: string }) {
  const holding = useSignal(false);
  const act = useMemo(() => ({ now: onPress }), []);
  act.now = onPress;
  const hold = useMemo(
    () => new Hold(() => act.now(), (f, ms) => void setTimeout(f, ms), (h) => (holding.value = h)),
    [],
  );
  const release = (): void => hold.release();
  if (disabled) release();
  return (
    <button
      type="button"
      class={`button hold ${holding.value ? 'holding' : ''} ${rest.class ?? ''}`}
      disabled={disabled}
      onPointerDown={(e) => e.button === 0 && hold.press()}
      onPointerUp={release}
      onPointerLeave={release}
      onPointerCancel={release}
      onKeyDown={(e) => !e.repeat && (e.key === 'Enter' || e.key === ' ') && hold.press()}
      onKeyUp={release}
      onBlur={release}
      onContextMenu={(e) => e.preventDefault()}
    >
      <span class="hold-text">{children}</span>
      <span class="hold-hint">{hint}</span>
    </button>
  );
}
