// Before and after: two buttons, a slider between two versions, and a key that shows the other state while it is held.
import { el, pressed } from "./dom.ts";

/** What has a state before and one after: a repair, or two versions of a robot. */
export interface States {
  readonly shown: boolean;
  /** From before (0) to after (1). */
  readonly part: number;
  readonly isAfter: boolean;
  /** Whether what is between the two can be looked at. */
  readonly slides: boolean;
  readonly what: string;
  place(part: number): void;
}

// Milliseconds from one state to the other.
const MORPH = 450;

export class Compare {
  private readonly buttons = (["Before", "After"] as const).map((text, i) =>
    el("button", { type: "button", click: () => this.go(i === 1) }, text));
  private readonly slider = el("input", {
    type: "range", min: 0, max: 1, step: "any", "aria-label": "From before to after", input: () => this.slide(),
  });
  readonly element = el(
    "div", { class: "uc-compare uc-group", role: "group", "aria-label": "Before and after", hidden: true },
    this.buttons[0]!, this.slider, this.buttons[1]!,
  );
  private states: States | null = null;
  /** The state to return to while the key is held. */
  private held: boolean | null = null;
  private frame = 0;

  /** `changed` is called after each step from one state to the other. */
  constructor(private readonly changed: () => void) {
    addEventListener("keyup", ({ key }) => { if (key === "b") this.peek(false); });
    addEventListener("blur", () => this.peek(false));
  }

  show(states: States): void {
    this.states = states;
    this.element.hidden = !states.shown;
    this.slider.hidden = !states.slides;
    this.slider.value = String(states.part);
    this.buttons.forEach((button, i) => {
      pressed(button, states.isAfter === (i === 1));
      button.title = `${i ? "After" : "Before"} ${states.what} (hold b for the other state)`;
    });
  }

  private slide(): void {
    this.stop();
    this.states?.place(this.slider.valueAsNumber);
    this.changed();
  }

  /** Another finding is selected: what moves stops. */
  stop(): void {
    cancelAnimationFrame(this.frame);
    this.held = null;
  }

  peek(isHeld: boolean): void {
    const { states } = this;
    if (!states?.shown || isHeld === (this.held !== null)) return;
    const kept = this.held ?? states.isAfter;
    this.held = isHeld ? kept : null;
    this.go(isHeld ? !kept : kept);
  }

  private go(after: boolean): void {
    cancelAnimationFrame(this.frame);
    const { states } = this;
    if (!states?.shown) return;
    const to = after ? 1 : 0;
    const show = (part: number) => {
      states.place(part);
      this.changed();
    };
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return show(to);
    const from = states.part;
    const began = performance.now();
    const step = (now: number) => {
      const t = Math.min(1, Math.max(0, (now - began) / MORPH));
      show(from + (to - from) * t * t * (3 - 2 * t));
      if (t < 1) this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }
}
