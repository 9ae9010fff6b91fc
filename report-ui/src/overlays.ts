// What is drawn over the robot: mass, inertia, axes, frames, holes, overlaps and the ground.
import { BoxGeometry, Group, Matrix4, Mesh, Object3D, Quaternion, SphereGeometry, Vector3 } from "three";
import type { Inertia, Layer, ModelData } from "./data.ts";
import type { Anchor } from "./labels.ts";
import { IN_FRONT, mark, ORDER, shared, stroke } from "./materials.ts";
import type { Repair } from "./repair.ts";
import type { LinkNode, Robot } from "./robot.ts";
import {
  axisArrow, boxEdges, brokenBox, circle, dashes, fan, matrix, quarteredBall, strokes, triad, tubes, type Shapes,
} from "./shapes.ts";
import { length } from "./words.ts";

const LEAD = 11340; // kg/m³: RViz and Gazebo show a mass as a ball of lead.
export const COLORS = {
  box: 0xe600e6, cross: 0x12b34a, ellipsoid: 0x7c5cff, axis: 0x2f97c9, hole: 0x00c2e0, overlap: 0xff2d55,
  broken: 0xe0263c, after: 0x12a05c, turn: 0xd9480f,
} as const;
/** The colours of the layers, for their buttons. */
export const SWATCHES: Partial<Record<Layer, string>> = {
  visual: "#9aa6b4", collision: "#ffbe38", com: "", box: "#e600e6", ellipsoid: "#7c5cff", axes: "#2f97c9",
  frames: "", holes: "#00c2e0", overlaps: "#ff2d55", ground: "#12a05c",
};
/** The colour of the ground where the COM of the robot is beside its support. */
export const TIPS = "#e0263c";

/** Whether the COM of the robot is above its support. */
export function stands({ ground }: ModelData): boolean {
  return ground === null || ground.stands;
}

interface Overlay {
  layer: Layer;
  /** The links that it tells something about; none for the whole robot. */
  links: string[];
  /** The finding that it shows, where it belongs to one or to none. */
  finding?: string | null;
  object: Object3D;
  label?: Anchor;
  /** An inertia that belongs to no body. */
  broken?: boolean;
}

/** The layers that a model has something for. */
export function filled(robot: Robot, shapes: Shapes): Set<Layer> {
  const links = [...robot.links.values()].map((link) => link.data);
  const joints = [...robot.joints.values()];
  const has: Record<Layer, boolean> = {
    visual: links.some((l) => l.visual.length > 0),
    collision: links.some((l) => l.collision.length > 0),
    com: links.some((l) => l.mass !== null && l.com !== null),
    box: links.some((l) => l.inertia !== null),
    ellipsoid: links.some((l) => l.inertia !== null && l.inertia.impossible === undefined),
    axes: joints.some((j) => j.data.axis !== null && j.data.type !== "fixed"),
    frames: links.length > 0,
    holes: links.some((l) => l.visual.concat(l.collision).some((s) => s.mesh !== undefined && shapes.hasHoles(s.mesh))),
    overlaps: robot.data.overlaps.length > 0,
    ground: robot.data.ground !== null,
    preview: false,
  };
  return new Set((Object.keys(has) as Layer[]).filter((layer) => has[layer]));
}

export const glyphs = {
  ball: quarteredBall(),
  triad: triad(),
  thinTriad: triad(0.015),
  turn: axisArrow(true),
  slide: axisArrow(false),
  sphere: new SphereGeometry(1, 36, 20),
  box: new BoxGeometry(1, 1, 1),
};

export function placed<O extends Object3D>(object: O, at: Matrix4, order: number = ORDER.glyph): O {
  object.matrixAutoUpdate = false;
  object.matrix.copy(at);
  // A group's order would overrule that of what it holds.
  if (!(object instanceof Group)) object.renderOrder = order;
  return object;
}

export const scaled = (at: Matrix4, size: number) => at.clone().multiply(new Matrix4().makeScale(size, size, size));
const alongZ = (axis: number[]) =>
  new Matrix4().makeRotationFromQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...axis).normalize()));
export const moved = (x: number, y: number, z: number) => new Matrix4().makeTranslation(x, y, z);

/** The radius of a ball of lead with this mass, that can be seen on a robot of this size. */
export function ballRadius(mass: number, size: number): number {
  const lead = Math.cbrt((0.75 * mass) / (Math.PI * LEAD));
  return Math.min(Math.max(lead, 0.006 * size), 0.2 * size);
}

/** Segments as a line of so many pixels, drawn over everything. */
export function line(ends: ArrayLike<number>, color: number, pixels: number, at = new Matrix4()): Mesh {
  return placed(new Mesh(strokes(ends), stroke(color, pixels)), at);
}

export class Overlays {
  private readonly built = new Map<Layer, Overlay[]>();
  /** What can be seen now: layers with something real, and inertias of no body. */
  drawn: { layers: Set<Layer>; broken: boolean } = { layers: new Set(), broken: false };

  constructor(private readonly robot: Robot, private readonly shapes: Shapes) {}

  /** Shows the layers: `all` of every link, `some` of the links of a selection only. Of overlaps those of the finding that is
   * selected, if it has any. */
  show(all: Set<Layer>, some: Set<Layer>, lit: Set<string> | null, onlyLit: boolean, repair: Repair, finding?: string): Anchor[] {
    const anchors: Anchor[] = [];
    this.drawn = { layers: new Set(), broken: false };
    for (const layer of new Set([...all, ...some])) if (!this.built.has(layer)) this.built.set(layer, this.build(layer));
    for (const [layer, overlays] of this.built) {
      const isToldApart = finding !== undefined && overlays.some((overlay) => overlay.finding === finding);
      for (const overlay of overlays) {
        const ofLit = lit !== null && (isToldApart ? overlay.finding === finding : overlay.links.some((link) => lit.has(link)));
        const forAll = all.has(layer) && !(onlyLit && lit !== null && overlay.links.length > 0 && !ofLit);
        const isOn = forAll || (some.has(layer) && (ofLit || overlay.links.length === 0));
        overlay.object.visible = isOn && this.current(layer) && !this.replaced(overlay, repair);
        if (overlay.object.visible) {
          const { broken } = overlay;
          if (broken) this.drawn.broken = true;
          else this.drawn.layers.add(layer);
        }
        if (overlay.object.visible && overlay.label) anchors.push({ ...overlay.label, rank: overlay.label.rank + (ofLit ? 4 : 0) });
      }
    }
    return anchors;
  }

  /** What was found at the start does not hold in another pose. */
  private current(layer: Layer): boolean {
    return layer !== "ground" || this.robot.neutral;
  }

  /** A repair draws frames and inertias itself, and may move the COM. */
  private replaced({ layer, links }: Overlay, repair: Repair): boolean {
    if (layer === "frames") return links.length === 1 && repair.frames.has(links[0]);
    return (layer === "box" || (layer === "com" && repair.isAfter)) && links.some((link) => repair.inertias.has(link));
  }

  private build(layer: Layer): Overlay[] {
    const links = [...this.robot.links.values()].filter((link) => link.frame.parent);
    switch (layer) {
      case "com": return links.flatMap((link) => this.com(link));
      case "box": return links.flatMap((link) => this.inertia(link, "box"));
      case "ellipsoid": return links.flatMap((link) => this.inertia(link, "ellipsoid"));
      case "axes": return this.axes();
      case "frames": return [...links.map((link) => this.frame(link)), ...this.jointFrames(), ...this.launchFrames()];
      case "holes": return links.flatMap((link) => this.holes(link));
      case "overlaps": return this.overlaps();
      case "ground": return this.ground();
      default: return [];
    }
  }

  private com(link: LinkNode): Overlay[] {
    const { mass, com, name } = link.data;
    if (mass === null || !com || !(mass > 0)) return [];
    const radius = ballRadius(mass, this.robot.size);
    const ball = placed(new Mesh(glyphs.ball, shared.glyph), scaled(moved(com[0], com[1], com[2]), radius));
    link.frame.add(ball);
    return [{ layer: "com", links: [name], object: ball }];
  }

  private inertia(link: LinkNode, layer: "box" | "ellipsoid"): Overlay[] {
    const inertia = link.data.inertia;
    if (!inertia) return [];
    const object = inertia.impossible === undefined
      ? body(inertia, layer, COLORS[layer])
      : layer === "box" ? this.broken(link, inertia.com) : null;
    if (!object) return [];
    link.frame.add(object);
    const label: Anchor | undefined = inertia.impossible === undefined
      ? undefined
      : { text: `${link.data.name}: no real body`, title: inertia.impossible, object, kind: "error", rank: 2 };
    return [{ layer, links: [link.data.name], object, label, broken: inertia.impossible !== undefined }];
  }

  /** Where an inertia belongs to no body there is no box to show, but that must be seen. */
  private broken(link: LinkNode, com: number[] | null): Object3D {
    const size = 0.8 * this.robot.unit(link);
    const [x, y, z] = com ?? link.data.com ?? [0, 0, 0];
    return line(brokenBox(size), COLORS.broken, 2.5, moved(x, y, z));
  }

  private axes(): Overlay[] {
    const overlays: Overlay[] = [];
    for (const joint of this.robot.joints.values()) {
      const { axis, type, name, child } = joint.data;
      if (!axis || type === "fixed") continue;
      const geometry = type === "prismatic" ? glyphs.slide : glyphs.turn;
      const size = 1.15 * this.robot.unit(this.robot.links.get(child)!);
      const arrow = placed(new Mesh(geometry, mark(COLORS.axis)), scaled(alongZ(axis), size));
      arrow.material = axisMaterial;
      joint.origin.add(arrow);
      overlays.push({
        layer: "axes", links: [child], object: arrow,
        label: { text: name, object: arrow, kind: "joint", rank: 0 },
      });
    }
    return overlays;
  }

  private frame(link: LinkNode): Overlay {
    const object = placed(new Mesh(glyphs.triad, shared.glyph), scaled(new Matrix4(), this.robot.unit(link)));
    link.frame.add(object);
    return {
      layer: "frames", links: [link.data.name], object,
      label: { text: link.data.name, object, kind: "link", rank: 0 },
    };
  }

  /** Longer and thinner: they lie in the frames of the links until a joint moves. */
  private jointFrames(): Overlay[] {
    return this.robot.movable.map((joint) => {
      const child = this.robot.links.get(joint.data.child)!;
      const object = placed(new Mesh(glyphs.thinTriad, shared.glyph), scaled(new Matrix4(), 1.35 * this.robot.unit(child)));
      joint.origin.add(object);
      return { layer: "frames", links: [joint.data.child], object };
    });
  }

  /** Frames that a launch file publishes, on whatever they hang. */
  private launchFrames(): Overlay[] {
    const holders = new Map<string, Object3D>([...this.robot.links].map(([name, link]) => [name, link.frame]));
    const overlays: Overlay[] = [];
    let waiting = this.robot.data.frames;
    for (let before = -1; waiting.length && waiting.length !== before; ) {
      before = waiting.length;
      waiting = waiting.filter((frame) => {
        const holder = holders.get(frame.parent);
        // A frame above the root is where the root hangs: its parent is shown in the root's terms.
        const above = !holder && holders.get(frame.child);
        if (!holder && !above) return true;
        const at = holder ? matrix(frame.at) : matrix(frame.at).invert();
        const name = holder ? frame.child : frame.parent;
        const group = placed(new Group(), at);
        const size = 0.05 * this.robot.size;
        const axes = placed(new Mesh(glyphs.triad, shared.glyph), scaled(new Matrix4(), size));
        const back = new Vector3().setFromMatrixPosition(at.clone().invert());
        group.add(axes, line(dashes(new Vector3(), back), COLORS.axis, 2));
        (holder || above || this.robot.root).add(group);
        if (!holders.has(name)) holders.set(name, group);
        overlays.push({
          layer: "frames", links: [frame.parent, frame.child], object: group,
          label: { text: name, object: axes, kind: "frame", rank: 1 },
        });
        return false;
      });
    }
    return overlays;
  }

  private holes(link: LinkNode): Overlay[] {
    const overlays: Overlay[] = [];
    // A file that is drawn and collides has the same holes twice.
    const seen = new Set<string>();
    for (const shape of [...link.data.visual, ...link.data.collision]) {
      if (shape.mesh === undefined || !this.shapes.hasHoles(shape.mesh)) continue;
      const key = JSON.stringify([shape.mesh, shape.at, shape.scale]);
      if (seen.has(key)) continue;
      seen.add(key);
      const at = matrix(shape.at).multiply(new Matrix4().makeScale(...(shape.scale as [number, number, number])));
      const ends = this.shapes.edges(shape.mesh).slice();
      const point = new Vector3();
      for (let i = 0; i < ends.length; i += 3) point.fromArray(ends, i).applyMatrix4(at).toArray(ends, i);
      const object = line(ends, COLORS.hole, 2.5);
      link.frame.add(object);
      overlays.push({ layer: "holes", links: [link.data.name], object });
    }
    return overlays;
  }

  private overlaps(): Overlay[] {
    const overlays: Overlay[] = [];
    const start = this.startFrames();
    const deepest = Math.max(...this.robot.data.overlaps.map(({ depth }) => depth ?? 0), Number.MIN_VALUE);
    for (const { a, b, points, depth, finding } of this.robot.data.overlaps) {
      const link = this.robot.links.get(a);
      const frame = start.get(a);
      if (!link || !frame || !points.length) continue;
      const group = placed(new Group(), new Matrix4());
      const size = 0.2 * Math.min(this.robot.unit(link), this.robot.unit(this.robot.links.get(b) ?? link));
      for (const point of points) {
        const at = new Vector3(...point).applyMatrix4(frame);
        const spot = placed(new Mesh(overlapGlyph, overlapMaterial), scaled(moved(at.x, at.y, at.z), size));
        group.add(spot);
      }
      link.frame.add(group);
      // Names may be long, and what is cut is the end.
      const deep = depth === null ? "" : `${length(depth)} deep: `;
      const label: Anchor = { text: `${deep}${a} × ${b}`, object: group.children[0], kind: "error", rank: 2 + (depth ?? 0) / deepest };
      overlays.push({ layer: "overlaps", links: [a, b], finding, object: group, label });
    }
    return overlays;
  }

  /** From the world to each link with every joint at its start. */
  private startFrames(): Map<string, Matrix4> {
    const values = new Map([...this.robot.joints].map(([name, joint]) => [name, joint.value]));
    for (const joint of this.robot.joints.values()) this.robot.set(joint.data.name, joint.data.start);
    this.robot.root.updateMatrixWorld(true);
    const frames = new Map([...this.robot.links].map(([name, link]) => [name, link.frame.matrixWorld.clone().invert()]));
    for (const [name, value] of values) this.robot.set(name, value);
    this.robot.root.updateMatrixWorld(true);
    return frames;
  }

  private ground(): Overlay[] {
    const ground = this.robot.data.ground;
    if (!ground) return [];
    const group = placed(new Group(), new Matrix4());
    const size = this.robot.size;
    const z = ground.height;
    const [x, y, height] = ground.com;
    const inside = stands(this.robot.data);
    const color = inside ? COLORS.after : COLORS.broken;
    const corners = ground.support.map(([cx, cy]) => new Vector3(cx, cy, z + 0.001 * size));
    if (corners.length >= 2) {
      const outline = corners.flatMap((corner, i) => [...corner.toArray(), ...corners[(i + 1) % corners.length].toArray()]);
      group.add(line(outline, color, 2));
    }
    if (corners.length >= 3) {
      group.add(placed(new Mesh(fan(corners), mark(color, 0.2)), new Matrix4(), ORDER.shade));
    }
    const spot = circle(0.016 * size, 28);
    for (const { point } of ground.contacts) {
      group.add(line(spot, color, 2, moved(point[0], point[1], z + 0.001 * size)));
    }
    const top = new Vector3(x, y, height);
    const foot = new Vector3(x, y, z + 0.001 * size);
    const cross = 0.03 * size;
    const lines = [
      ...dashes(top, foot, 11),
      x - cross, y, foot.z, x + cross, y, foot.z, x, y - cross, foot.z, x, y + cross, foot.z,
    ];
    group.add(line(lines, color, 2));
    const ball = placed(new Mesh(glyphs.ball, shared.glyph), scaled(moved(x, y, height), 0.022 * size));
    group.add(ball);
    this.robot.root.add(group);
    const pose = this.robot.startsAtZero ? "" : " with all joints at zero";
    const text = inside ? `COM of the robot${pose}` : `COM of the robot${pose}, outside its support`;
    return [{ layer: "ground", links: [], object: group, label: { text, object: ball, kind: inside ? "ok" : "error", rank: 3 } }];
  }
}

/** The box or ellipsoid of an inertia: a translucent solid where it is in front of the robot, its lines everywhere. */
export function body(inertia: Exclude<Inertia, { impossible: string }>, layer: "box" | "ellipsoid", color: number): Group {
  const at = matrix(inertia.at);
  const group = placed(new Group(), at);
  const size = layer === "box" ? inertia.box : inertia.ellipsoid;
  const scale = new Matrix4().makeScale(...(size.map((s) => Math.max(s, 1e-6)) as [number, number, number]));
  const geometry = layer === "box" ? glyphs.box : glyphs.sphere;
  const front = mark(color, 0.38);
  front.setValues(IN_FRONT);
  const solid = placed(new Mesh(geometry, front), scale, ORDER.volume);
  solid.name = layer;
  const hidden = placed(new Mesh(geometry, mark(color, 0.1)), scale, ORDER.veil);
  group.add(solid, hidden);
  if (layer === "box") {
    const [x, y, z] = size;
    group.add(line(boxEdges(size), color, 1.75));
    const cross = [-x, 0, 0, x, 0, 0, 0, -y, 0, 0, y, 0, 0, 0, -z, 0, 0, z];
    group.add(line(cross, COLORS.cross, 1.5));
  } else {
    const turns = [new Matrix4(), new Matrix4().makeRotationX(Math.PI / 2), new Matrix4().makeRotationY(Math.PI / 2)];
    for (const turn of turns) {
      const ends = circle(1);
      const point = new Vector3();
      const to = scale.clone().multiply(turn);
      for (let i = 0; i < ends.length; i += 3) point.fromArray(ends, i).applyMatrix4(to).toArray(ends, i);
      group.add(line(ends, color, 1.5));
    }
  }
  return group;
}

const axisMaterial = mark(COLORS.axis);
const overlapMaterial = mark(COLORS.overlap);
// A star of three bars.
const overlapGlyph = tubes(
  [-1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, ...boxEdges([0.7, 0.7, 0.7])], 0.09,
);
