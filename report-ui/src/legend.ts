// What the marks on the picture mean.
import type { Layer } from "./data.ts";
import { el } from "./dom.ts";
import type { Line } from "./outline.ts";
import { KEYED, swatch, WORDS } from "./toolbar.ts";

/** What is drawn. */
export interface Marks {
  layers: Set<Layer>;
  lines: Set<Line>;
  /** Whether there is an inertia that belongs to no body. */
  broken: boolean;
  /** Whether the COM of the robot is above its support. */
  stands: boolean;
  /** Whether two versions are compared: then lines tell them apart. */
  versions: boolean;
  repair: { isAfter: boolean; line: Line; turns: boolean; frames: Set<string>; inertias: Set<string>; broken: boolean; coms: boolean };
}

// Below this width of the picture, in pixels, the legend is closed at first.
const NARROW = 600;

/** The lines of the legend: the kind of each mark, and what it means. */
export function explain({ layers, lines, broken, stands, versions, repair }: Marks): [string, string][] {
  const { isAfter: after } = repair;
  const moves = repair.frames.size > 0;
  const said: [string, string | false][] = [
    ["line error", !moves && lines.has("error") && "Link or joint with an error"],
    ["line warning", !moves && lines.has("warning") && (versions ? "Before: no longer there" : "Link or joint with a warning")],
    ["line other", lines.has("other") && !moves && (versions ? "After: not there before" : "Link after the repair")],
    [`line ${repair.line}`, moves && lines.has(repair.line) && `The part ${after ? "before" : "after"} the repair`],
    ["turn", repair.turns && "Rotation from the repaired frame"],
    [`shown ${after ? "after" : "before"}`, repair.inertias.size > 0 && (after || !repair.broken) && `Inertia box ${after ? "after" : "before"} the repair`],
    [`dashed ${after ? "before" : "after"}`, repair.inertias.size > 0 && (!after || !repair.broken) && `Inertia box ${after ? "before" : "after"} the repair`],
    ["broken", (broken || (repair.broken && !after)) && "Split box: no real body has this inertia"],
  ];
  for (const layer of KEYED) {
    if (layer !== "visual" && (layers.has(layer) || (moves && layer === "frames") || (repair.coms && layer === "com"))) said.push([layer === "ground" && !stands ? "ground tips" : layer, WORDS[layer][1]]);
  }
  return said.filter((line): line is [string, string] => line[1] !== false);
}

export class Legend {
  private readonly list = el("ul");
  readonly element = el("details", { class: "uc-legend" }, el("summary", {}, "Legend"), this.list);
  private shown = "";

  constructor(width: number) {
    this.element.open = width > NARROW;
  }

  show(marks: Marks): void {
    const lines = explain(marks);
    const shown = JSON.stringify(lines);
    if (shown === this.shown) return;
    this.shown = shown;
    this.element.hidden = !lines.length;
    this.list.replaceChildren(...lines.map(([kind, text]) => el("li", {}, swatch(kind), text)));
  }
}
