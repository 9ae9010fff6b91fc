// A hint of shadow on the ground: the outlines of the links from above, blurred, fainter the higher they are.
import { CanvasTexture, Mesh, MeshBasicMaterial, PlaneGeometry, Vector3 } from "three";
import type { Robot } from "./robot.ts";

const CELLS = 160;

export class Shadow {
  private readonly context: CanvasRenderingContext2D;
  private readonly texture: CanvasTexture;
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;

  constructor() {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = CELLS;
    this.context = canvas.getContext("2d")!;
    this.texture = new CanvasTexture(canvas);
    const material = new MeshBasicMaterial({ map: this.texture, transparent: true, depthWrite: false });
    this.mesh = new Mesh(new PlaneGeometry(1, 1), material);
    this.mesh.renderOrder = -1;
  }

  /** Beside ghosts it would be the darkest thing in the picture. */
  show(shown: boolean, dark: boolean, ghosts: boolean): void {
    this.mesh.visible = shown;
    this.mesh.material.opacity = (dark ? 0.75 : 0.4) * (ghosts ? 0.3 : 1);
  }

  cast(robot: Robot, ground: number): void {
    const middle = robot.box.getCenter(new Vector3());
    const width = 1.5 * robot.size;
    this.mesh.scale.set(width, width, 1);
    this.mesh.position.set(middle.x, middle.y, ground);
    const { context } = this;
    context.clearRect(0, 0, CELLS, CELLS);
    for (const link of robot.links.values()) {
      if (!link.bodies.length) continue;
      const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => {
        const { min, max } = link.box;
        return new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z).applyMatrix4(link.frame.matrixWorld);
      });
      const above = Math.max(0, Math.min(...corners.map((corner) => corner.z)) - ground) / robot.size;
      const cells = corners.map(({ x, y }) => [
        ((x - middle.x) / width + 0.5) * CELLS, (0.5 - (y - middle.y) / width) * CELLS,
      ]);
      // What is drawn lies beside the canvas: only its blurred shadow falls on it.
      context.shadowColor = `rgb(0 0 0 / ${0.75 * Math.exp(-5 * above)})`;
      context.shadowBlur = 5 + 30 * above;
      context.shadowOffsetX = 2 * CELLS;
      context.beginPath();
      for (const [x, y] of outline(cells)) context.lineTo(x - 2 * CELLS, y);
      context.fill();
    }
    this.texture.needsUpdate = true;
  }
}

/** The convex outline of points in the plane, by Andrew's monotone chain. */
function outline(points: number[][]): number[][] {
  const sorted = points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (order: number[][]) => {
    const chain: number[][] = [];
    for (const p of order) {
      for (let n = chain.length; n > 1; n = chain.length) {
        const [a, b] = [chain[n - 2], chain[n - 1]];
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}
