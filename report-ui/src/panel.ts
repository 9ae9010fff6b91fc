// The drawer of the joints: a slider and a number for each that moves.
import { el, send } from "./dom.ts";
import type { JointNode, Robot } from "./robot.ts";

const MANY = 12;
// Joints that the note names before it counts the rest.
const NAMED = 8;
const DEGREE = Math.PI / 180;

interface Row {
  joint: JointNode;
  row: HTMLElement;
  slider: HTMLInputElement;
  number: HTMLInputElement;
  unit: HTMLElement;
}

export class JointPanel {
  private rows: Row[] = [];
  private readonly summary = el("summary");
  private readonly note = el("p", { class: "uc-joint-note", hidden: true });
  private readonly list = el("div", { class: "uc-joint-list" });
  private readonly filter = el("input", { type: "search", placeholder: "filter", "aria-label": "Filter the joints by name" });
  private readonly degrees = el("button", { type: "button", "aria-pressed": "false", title: "Degrees instead of radians" }, "deg");
  private robot: Robot | null = null;

  /** `moved` is called after each change of the pose. */
  constructor(private readonly drawer: HTMLDetailsElement, private readonly moved: () => void) {
    const pose = (text: string, value: (joint: JointNode) => number) =>
      el("button", { type: "button", click: () => this.pose(value) }, text);
    this.degrees.addEventListener("click", () => {
      this.degrees.setAttribute("aria-pressed", String(!this.inDegrees));
      this.refresh(true);
    });
    this.filter.addEventListener("input", () => {
      const wanted = this.filter.value.toLowerCase();
      for (const { row, joint } of this.rows) row.hidden = !joint.data.name.toLowerCase().includes(wanted);
    });
    const tools = el(
      "div", { class: "uc-joint-tools" },
      pose("Neutral", (joint) => joint.data.start),
      pose("Lower", (joint) => joint.lower),
      pose("Upper", (joint) => joint.upper),
      pose("Random", (joint) => joint.lower + Math.random() * (joint.upper - joint.lower)),
      this.degrees,
      this.filter,
    );
    drawer.replaceChildren(this.summary, el("div", { class: "uc-joint-body" }, tools, this.note, this.list));
  }

  private get inDegrees(): boolean {
    return this.degrees.getAttribute("aria-pressed") === "true";
  }

  show(robot: Robot): void {
    this.robot = robot;
    const joints = robot.movable;
    this.drawer.hidden = joints.length === 0;
    this.summary.textContent = `Joints (${joints.length})`;
    this.filter.hidden = joints.length <= MANY;
    this.filter.value = "";
    const clamped = joints.filter(({ data }) => !data.mimic && data.start !== 0).map(({ data }) => data.name);
    const more = clamped.length > NAMED ? ` and ${clamped.length - NAMED} more` : "";
    this.note.hidden = !clamped.length;
    this.note.textContent = `Zero is outside the limits of ${clamped.slice(0, NAMED).join(", ")}${more}: drawn at the limit next to it.`;
    this.rows = joints.map((joint) => this.row(joint));
    this.list.replaceChildren(...this.rows.map(({ row }) => row));
    this.refresh(true);
  }

  private row(joint: JointNode): Row {
    const { name, mimic } = joint.data;
    const follows = mimic ? `follows ${mimic.joint}` : "";
    const label = el(
      "button",
      { type: "button", class: "uc-joint-name", title: name, click: () => send("uc:select", { model: this.robot!.data.id, joint: name, origin: "viewer" }) },
      name,
    );
    const off = mimic !== null;
    const slider = el("input", { type: "range", step: "any", "aria-label": name, disabled: off });
    const number = el("input", { type: "number", step: "any", "aria-label": `Value of ${name}`, disabled: off });
    slider.addEventListener("input", () => this.set(joint, this.metric(joint, slider.valueAsNumber)));
    number.addEventListener("change", () => {
      const typed = this.metric(joint, number.valueAsNumber);
      if (Number.isFinite(typed)) this.set(joint, Math.min(joint.upper, Math.max(joint.lower, typed)));
      this.refresh();
    });
    const unit = el("span", { class: "uc-unit" });
    const row = el("div", { class: "uc-joint" }, label, slider, number, unit);
    if (mimic) row.append(el("span", { class: "uc-follows" }, follows));
    return { joint, row, slider, number, unit };
  }

  private set(joint: JointNode, value: number): void {
    this.robot?.set(joint.data.name, value);
    this.refresh();
    this.moved();
  }

  private pose(value: (joint: JointNode) => number): void {
    for (const { joint } of this.rows) this.robot?.set(joint.data.name, value(joint));
    this.refresh();
    this.moved();
  }

  private factor(joint: JointNode): number {
    return this.inDegrees && joint.data.type !== "prismatic" ? DEGREE : 1;
  }

  private metric(joint: JointNode, shown: number): number {
    return shown * this.factor(joint);
  }

  /** Writes the pose into the rows; with `limits` the ends of the sliders too. */
  refresh(limits = false): void {
    for (const { joint, slider, number, unit } of this.rows) {
      const factor = this.factor(joint);
      const digits = factor === 1 ? 3 : 1;
      if (limits) {
        const ends = [Math.min(joint.lower, joint.value), Math.max(joint.upper, joint.value)].map((end) => end / factor);
        [slider.min, slider.max] = ends.map(String);
        number.step = factor === 1 ? "0.01" : "1";
        unit.textContent = joint.data.type === "prismatic" ? "m" : factor === 1 ? "rad" : "°";
        slider.title = number.title = `${ends[0].toFixed(digits)} to ${ends[1].toFixed(digits)} ${unit.textContent}`;
      }
      slider.value = String(joint.value / factor);
      number.value = (joint.value / factor).toFixed(digits);
    }
  }
}
