// Before and after a repair: two buttons, and a key that shows the other state while it is held.
import { el, pressed } from "./dom.ts";
import type { Repair } from "./repair.ts";

// Milliseconds from one state to the other.
const MORPH = 450;

export class Compare {
  private readonly buttons = (["Before", "After"] as const).map((text, i) =>
    el("button", { type: "button", title: `${text} the repair (hold b for the other state)`, click: () => this.go(i === 1) }, text));
  readonly element = el("div", { class: "uc-compare uc-group", role: "group", "aria-label": "Repair", hidden: true }, ...this.buttons);
  private repair: Repair | null = null;
  /** The state to return to while the key is held. */
  private held: boolean | null = null;
  private frame = 0;

  /** `changed` is called after each step from one state to the other. */
  constructor(private readonly changed: () => void) {
    addEventListener("keyup", ({ key }) => { if (key === "b") this.peek(false); });
    addEventListener("blur", () => this.peek(false));
  }

  show(repair: Repair): void {
    this.repair = repair;
    this.element.hidden = !repair.shown;
    this.buttons.forEach((button, i) => pressed(button, repair.after === (i === 1)));
  }

  /** Another finding is selected: what moves stops. */
  stop(): void {
    cancelAnimationFrame(this.frame);
    this.held = null;
  }

  peek(isHeld: boolean): void {
    const { repair } = this;
    if (!repair?.shown || isHeld === (this.held !== null)) return;
    const kept = this.held ?? repair.after;
    this.held = isHeld ? kept : null;
    this.go(isHeld ? !kept : kept);
  }

  private go(after: boolean): void {
    cancelAnimationFrame(this.frame);
    const { repair } = this;
    if (!repair?.shown) return;
    const to = after ? 1 : 0;
    const show = (part: number) => {
      repair.place(part);
      this.changed();
    };
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return show(to);
    const from = repair.part;
    const began = performance.now();
    const step = (now: number) => {
      const t = Math.min(1, Math.max(0, (now - began) / MORPH));
      show(from + (to - from) * t * t * (3 - 2 * t));
      if (t < 1) this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }
}
