// Two versions of a robot in one picture: what is equal is drawn once, what differs fades from one version to the other.
import { BufferGeometry, Color, Group, Matrix4, Mesh, Vector3 } from "three";
import type { Finding, Layer, ModelData } from "./data.ts";
import type { Anchor } from "./labels.ts";
import { edge, ORDER, shared } from "./materials.ts";
import type { Outlined } from "./outline.ts";
import { COLORS, filled, line, Overlays, placed } from "./overlays.ts";
import { positionOf, Robot, type Body, type Look } from "./robot.ts";
import { dashes, type Shapes } from "./shapes.ts";
import type { Theme } from "./theme.ts";
import { distance } from "./words.ts";

/** In metres: surfaces that are nearer to each other are equal, as for `urdfcheck diff` itself. */
const EQUAL = 2e-5;
/** How much of the version that is not chosen can be seen. */
const PALE = 0.3;
/** What was before has a tone of its own: it may have the colour of what is after. */
const BEFORE = new Color(0xf0a030);
/** Where both versions have a surface in one place, that of the second is seen. */
const BEHIND = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4 };
const DEPTH_BEHIND = Object.assign(shared.depth.clone(), BEHIND);
/** A shorter way than this part of the robot is not worth a line. */
const LEAST_WAY = 1e-3;

export class Versions {
  readonly before: Robot;
  readonly overlays: Overlays;
  readonly offered: Set<Layer>;
  /** From before (0) to after (1). */
  part = 1;
  readonly shown = true;
  readonly slides = true;
  readonly what = "the change";
  /** The bodies of each version that the other one does not have in the same place. */
  private lost = new Set<Body>();
  private gained = new Set<Body>();
  /** In the world. */
  readonly ways = placed(new Group(), new Matrix4());
  private marks: Anchor[] = [];

  constructor(private readonly after: Robot, before: ModelData, shapes: Shapes) {
    this.before = new Robot(before, shapes, after.data.beforeAt);
    this.overlays = new Overlays(this.before, shapes);
    this.offered = filled(this.before, shapes);
    this.pose();
  }

  get isAfter(): boolean {
    return this.part > 0.5;
  }

  /** What the first version calls a link of the second. */
  nameBefore(link: string): string {
    return this.after.data.renamed?.links[link] ?? link;
  }

  place(part: number): void {
    this.part = part;
  }

  /** Gives the first version the joint positions of the second, and finds what differs. */
  pose(): void {
    const joints = this.after.data.renamed?.joints ?? {};
    for (const joint of this.after.movable) this.before.set(joints[joint.data.name] ?? joint.data.name, joint.value);
    for (const robot of [this.before, this.after]) robot.root.updateMatrixWorld(true);
    const [olds, news] = [this.before, this.after].map((robot) => [...robot.links.values()].flatMap((link) => link.bodies));
    this.lost = unmatched(olds!, news!);
    this.gained = unmatched(news!, olds!);
  }

  /** Gives both versions their look after the second was dressed; `lit`: the links of the first that stay while others are left out. */
  dress(outlined: Outlined[], look: Look, lit: Set<string> | null, theme: Theme): Outlined[] {
    this.before.dress({ ...look, collision: look.collision && !this.isAfter, lit: null, outline: () => "", hovered: null }, theme);
    for (const link of this.before.links.values()) {
      const isLit = lit === null || lit.has(link.data.name);
      for (const body of link.bodies) {
        body.mesh.visible = look.visual && isLit && this.lost.has(body);
        body.depth.visible = false;
        body.depth.material = DEPTH_BEHIND;
        Object.assign(body.own, BEHIND);
        if (!body.mesh.visible) continue;
        body.own.color.copy(body.base).lerp(BEFORE, 0.4 + 0.4 * this.part);
        edge(body.own, theme, BEFORE);
        fade(body, Math.max(PALE, 1 - this.part));
        outlined.push({ mesh: body.mesh, line: "warning", isThrough: this.isAfter });
      }
      for (const mesh of link.collisions) mesh.visible &&= isLit;
    }
    const gained = new Set<Mesh>([...this.gained].map(({ mesh }) => mesh));
    for (const item of outlined) {
      // Of two surfaces in one place neither hides the other.
      if (gained.has(item.mesh)) Object.assign(item, { line: "other", isThrough: !this.isAfter });
    }
    for (const link of this.after.links.values()) {
      for (const body of link.bodies) {
        if (body.mesh.visible && body.mesh.material === body.own) fade(body, this.gained.has(body) ? Math.max(PALE, this.part) : 1);
      }
    }
    return outlined;
  }

  /** Draws how far the links of a change are from where they were. */
  trace(finding: Finding | null): void {
    for (const child of [...this.ways.children]) child.removeFromParent();
    this.marks = [];
    const names = finding?.before ?? [];
    for (const [i, name] of names.entries()) {
      const old = this.before.links.get(name);
      const now = this.after.links.get(finding!.links[i] ?? "");
      if (old && !now) this.marks.push({ text: `${name}, before`, object: old.frame, kind: "frame", rank: 8 });
      if (!old || !now) continue;
      const [from, to] = [positionOf(old.frame), positionOf(now.frame)];
      if (from.distanceTo(to) < Math.max(LEAST_WAY * this.after.size, EQUAL)) continue;
      const middle = placed(new Group(), new Matrix4().setPosition(from.clone().lerp(to, 0.5)));
      this.ways.add(line(dashes(from, to), COLORS.after, 2.5), middle);
      this.marks.push({ text: `${name} moves ${distance(from.distanceTo(to))}`, object: middle, about: now.data.name, kind: "turn", rank: 10 });
    }
    this.ways.updateMatrixWorld(true);
  }

  get anchors(): Anchor[] {
    return this.marks;
  }

  /** How many bodies differ, in each version. */
  get counts(): [number, number] {
    return [this.lost.size, this.gained.size];
  }
}

/** The bodies for which no other one has the same surface, look and place. */
export function unmatched(bodies: Body[], others: Body[]): Set<Body> {
  const known = new Map<string, Vector3[][]>();
  for (const other of others) {
    const key = keyOf(other);
    known.set(key, [...(known.get(key) ?? []), corners(other.mesh)]);
  }
  return new Set(bodies.filter((body) => {
    const own = corners(body.mesh);
    return !known.get(keyOf(body))?.some((there) => there.every((corner, i) => corner.distanceTo(own[i]!) < EQUAL));
  }));
}

function keyOf({ shape: { mesh, box, cylinder, sphere, capsule, color } }: Body): string {
  // The sizes of all but a capsule are in its matrix.
  return JSON.stringify([mesh ?? null, Boolean(box), Boolean(cylinder), Boolean(sphere), capsule ?? null, color]);
}

/** The corners of the bounds of a mesh, in the world. */
function corners(mesh: Mesh<BufferGeometry>): Vector3[] {
  if (!mesh.geometry.boundingBox) mesh.geometry.computeBoundingBox();
  const { min, max } = mesh.geometry.boundingBox!;
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) =>
    new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z).applyMatrix4(mesh.matrixWorld));
}

/** Makes a body see-through; nothing of its inside shows. */
function fade(body: Body, part: number): void {
  const { own, mesh, depth } = body;
  own.userData.alpha ??= own.opacity;
  const alpha = (own.userData.alpha as number) * part;
  const isClear = alpha < 0.99;
  if (own.transparent !== isClear) {
    own.transparent = isClear;
    own.needsUpdate = true;
  }
  own.opacity = isClear ? alpha : 1;
  own.depthWrite = !isClear;
  depth.visible = part < 0.99;
  mesh.renderOrder = part < 0.99 ? ORDER.ghost : 0;
}
