// The buttons over the picture.
import { LAYERS, type Layer } from "./data.ts";
import { el, icon, pressed } from "./dom.ts";
import { SWATCHES, TIPS } from "./overlays.ts";

/** The name of each layer, and what it shows. */
export const WORDS: Record<Exclude<Layer, "preview">, [string, string]> = {
  visual: ["Visual", "Visual shapes"],
  collision: ["Collision", "Collision shapes"],
  com: ["COM", "COM: a ball of lead with the mass of the link"],
  box: ["Inertia", "Uniform box with the mass and inertia of the link"],
  ellipsoid: ["Ellipsoid", "Uniform ellipsoid with the mass and inertia of the link"],
  axes: ["Axes", "Joint axis with its positive direction"],
  frames: ["Frames", "Frames: x red, y green, z blue"],
  holes: ["Holes", "Hole: mesh edges with only one triangle"],
  overlaps: ["Overlaps", "Overlap of collision shapes at rest"],
  ground: ["Ground", "Ground contacts, support polygon and COM of the robot"],
};
/** In the order of the keys 1 to 9 and 0. */
export const KEYED = LAYERS.filter((layer): layer is keyof typeof WORDS => layer !== "preview");

/** A mark in the colours of what it stands for. */
export function swatch(kind: string): HTMLElement {
  const mark = el("i", { class: `uc-swatch ${kind}`, "aria-hidden": "true" });
  const color = kind === "ground tips" ? TIPS : SWATCHES[kind as Layer];
  if (color) mark.style.background = color;
  return mark;
}

const ICONS = {
  home: "M2 8 8 2.5 14 8M4 7v6.5h8V7",
  full: "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4",
  picture: "M2 5h3l1-2h4l1 2h3v8H2zM8 11.2a2.4 2.4 0 1 0 0-4.8 2.4 2.4 0 0 0 0 4.8",
};

export interface Actions {
  layer(layer: Layer): void;
  outline(): void;
  only(): void;
  view(name: string): void;
  parallel(): void;
  home(): void;
  picture(): void;
  full(): void;
  model(index: number): void;
}

export class Toolbar {
  private readonly layers = new Map<Layer, HTMLButtonElement>();
  private readonly outline: HTMLButtonElement;
  private readonly only: HTMLButtonElement;
  private readonly parallel: HTMLButtonElement;
  private readonly ways: HTMLElement;
  readonly models: HTMLSelectElement | null;

  constructor(bar: HTMLElement, names: string[], actions: Actions) {
    const button = (text: string, title: string, click: () => void) => el("button", { type: "button", title, click }, text);
    const layers = el("div", { class: "uc-group uc-layers", role: "group", "aria-label": "Layers" });
    KEYED.forEach((layer, i) => {
      const [word, title] = WORDS[layer];
      const toggle = button(word, `${title} (key ${(i + 1) % 10})`, () => actions.layer(layer));
      toggle.prepend(swatch(layer));
      toggle.dataset.layer = layer;
      this.layers.set(layer, toggle);
      layers.append(toggle);
    });
    this.outline = button("Findings", "Outline links with errors and warnings", actions.outline);
    this.outline.dataset.layer = "findings";
    this.outline.prepend(swatch("findings"));
    this.only = button("Selected only", "Layers of the selected link only", actions.only);
    this.ways = el("div", { class: "uc-group", role: "group", "aria-label": "What stands out" }, this.outline, this.only);

    const views = el("div", { class: "uc-group", role: "group", "aria-label": "View" });
    for (const [name, title] of [["iso", "From the front, right and above"], ["front", "Along x"], ["left", "From the left, along y"], ["top", "From above, along z"]]) {
      const view = button(name[0].toUpperCase() + name.slice(1), title, () => actions.view(name));
      view.dataset.view = name;
      views.append(view);
    }
    this.parallel = button("Parallel", "Without perspective", actions.parallel);
    const drawn = (path: string, label: string, click: () => void) => {
      const made = el("button", { type: "button", class: "uc-icon", "aria-label": label, title: label, click });
      made.append(icon(path));
      return made;
    };
    const full = drawn(ICONS.full, "Full screen", actions.full);
    full.hidden = !document.fullscreenEnabled;
    views.append(
      this.parallel,
      drawn(ICONS.home, "The whole robot (key h)", actions.home),
      drawn(ICONS.picture, "Save a picture", actions.picture),
      full,
    );
    this.models = names.length > 1 ? el("select", { "aria-label": "Model" }) : null;
    if (this.models) {
      const { models } = this;
      names.forEach((name, i) => models.add(new Option(name, String(i))));
      models.addEventListener("change", () => actions.model(models.selectedIndex));
      views.prepend(models);
    }
    bar.append(layers, this.ways, views);
  }

  /** Which layers there are at all. */
  offer(layers: Set<Layer>, outlined: boolean, stands: boolean): void {
    for (const [layer, button] of this.layers) button.hidden = !layers.has(layer);
    this.layers.get("ground")!.firstElementChild!.replaceWith(swatch(stands ? "ground" : "ground tips"));
    this.outline.hidden = !outlined;
  }

  show(layers: Set<Layer>, outlined: boolean, only: boolean, parallel: boolean, selected: boolean): void {
    for (const [layer, button] of this.layers) pressed(button, layers.has(layer));
    pressed(this.outline, outlined);
    pressed(this.only, only);
    this.only.hidden = !selected;
    this.ways.hidden = this.outline.hidden && this.only.hidden;
    pressed(this.parallel, parallel);
  }
}
