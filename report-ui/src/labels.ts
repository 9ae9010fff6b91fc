// Names over the picture: elements of the page, with text only.
import { type Camera, type Object3D, Vector3 } from "three";
import { el } from "./dom.ts";
import { positionOf } from "./robot.ts";

export interface Anchor {
  text: string;
  title?: string;
  object: Object3D;
  /** The link that it names with more words: it needs no second label. */
  about?: string;
  kind: "link" | "joint" | "frame" | "error" | "ok" | "turn";
  /** Where two labels would lie over each other the higher one stays. */
  rank: number;
}

interface Placed extends Anchor {
  element: HTMLElement;
  width: number;
  height: number;
}

export class Labels {
  private placed: Placed[] = [];
  private shown = "";

  constructor(private readonly layer: HTMLElement) {}

  set(anchors: Anchor[]): void {
    const sorted = anchors.slice().sort((a, b) => b.rank - a.rank);
    const shown = JSON.stringify(sorted.map(({ text, kind, object }) => [text, kind, object.id]));
    if (shown === this.shown) return;
    this.shown = shown;
    this.placed = sorted.map((anchor) => {
      const element = el("span", { class: `uc-label ${anchor.kind}`, ...(anchor.title ? { title: anchor.title } : {}) }, anchor.text);
      return { ...anchor, element, width: 0, height: 0 };
    });
    this.layer.replaceChildren(...this.placed.map((label) => label.element));
    for (const label of this.placed) {
      label.width = label.element.offsetWidth;
      label.height = label.element.offsetHeight;
    }
  }

  /** Puts each label beside its object, unless it would cover one that ranks higher; below it where the buttons are, which end
   * at `top`. */
  place(camera: Camera, width: number, height: number, top: number): void {
    const taken: [number, number, number, number][] = [];
    const at = new Vector3();
    for (const label of this.placed) {
      at.copy(positionOf(label.object)).project(camera);
      const x = Math.round(((at.x + 1) / 2) * width) + 10;
      const point = Math.round(((1 - at.y) / 2) * height);
      const above = point - label.height - 4;
      const y = above < top && point >= top ? point + 6 : above;
      const left = Math.min(x, width - label.width - 4);
      const box: [number, number, number, number] = [left, y, left + label.width, y + label.height];
      const free = taken.every(([l, t, r, b]) => box[2] < l || box[0] > r || box[3] < t || box[1] > b);
      const seen = at.z < 1 && Math.abs(at.x) < 1 && Math.abs(at.y) < 1 && free;
      label.element.style.visibility = seen ? "visible" : "hidden";
      if (!seen) continue;
      taken.push(box);
      label.element.style.transform = `translate(${left}px, ${y}px)`;
    }
  }
}
