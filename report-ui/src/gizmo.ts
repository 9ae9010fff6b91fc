// The axes of the world in a corner, as the camera sees them.
import { type Camera, Vector3 } from "three";
import { svg } from "./dom.ts";
import { AXIS_COLORS } from "./shapes.ts";

export class Gizmo {
  readonly element = svg("svg", { class: "uc-gizmo", viewBox: "-32 -32 64 64", "aria-hidden": "true" });
  private readonly axes = ["x", "y", "z"].map((name, i) => {
    const line = svg("line", { stroke: AXIS_COLORS[i] });
    const text = svg("text", { class: `uc-axis-${name}` });
    text.textContent = name;
    return svg("g", {}, line, text);
  });

  turn(camera: Camera): void {
    const back = camera.quaternion.clone().invert();
    const seen = this.axes.map((group, i) => {
      const tip = new Vector3().setComponent(i, 1).applyQuaternion(back);
      const [line, text] = group.children;
      line.setAttribute("x2", (19 * tip.x).toFixed(1));
      line.setAttribute("y2", (-19 * tip.y).toFixed(1));
      text.setAttribute("x", (26 * tip.x).toFixed(1));
      text.setAttribute("y", (-26 * tip.y).toFixed(1));
      return { group, depth: tip.z };
    });
    // The one that points at the reader lies on top.
    this.element.replaceChildren(...seen.sort((a, b) => a.depth - b.depth).map(({ group }) => group));
  }
}
