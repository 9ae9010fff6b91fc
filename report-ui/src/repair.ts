// What a repair changes, before and after: one of both is drawn as the robot is, the other as an outline.
import { ConeGeometry, Group, Matrix4, Mesh, Object3D, Quaternion, Vector3 } from "three";
import type { Finding, Inertia, Preview, Severity } from "./data.ts";
import type { Anchor } from "./labels.ts";
import { mark, ORDER, shared } from "./materials.ts";
import type { Line, Outlined } from "./outline.ts";
import { ballRadius, body, COLORS, glyphs, line, moved, placed, scaled } from "./overlays.ts";
import { positionOf, type JointNode, type LinkNode, type Robot } from "./robot.ts";
import { boxEdges, brokenBox, dashes, fan, matrix } from "./shapes.ts";
import { angle, length } from "./words.ts";

/** Below this a rotation is the rounding of a file. */
const LEAST_ANGLE = 1e-4;

interface Step {
  /** Shows it between before (0) and after (1). */
  place(part: number): void;
  anchors(after: boolean): Anchor[];
  /** The meshes where they are in the other state. */
  other: Mesh[];
  /** What should be in view. */
  points: Vector3[];
  remove(): void;
}

export class Repair {
  private steps: Step[] = [];
  /** From before (0) to after (1). */
  part = 0;
  private severity: Severity = "";
  /** Links whose inertia, or whose frame, is drawn here and not by the layers. */
  readonly inertias = new Set<string>();
  readonly frames = new Set<string>();
  /** Whether a joint is rotated, and whether an inertia belongs to no body. */
  turns = false;
  broken = false;
  /** Whether it draws a COM where it will be. */
  coms = false;

  constructor(private readonly robot: Robot) {}

  get shown(): boolean {
    return this.steps.length > 0;
  }

  readonly slides = false;
  readonly what = "the repair";

  get isAfter(): boolean {
    return this.part > 0.5;
  }

  /** Draws what a finding proposes, as it is before; returns the points that should be in view. */
  show(finding: Finding | null): Vector3[] {
    this.place(0);
    for (const step of this.steps) step.remove();
    this.inertias.clear();
    this.frames.clear();
    this.severity = finding?.severity ?? "";
    this.turns = this.broken = this.coms = false;
    this.robot.root.updateMatrixWorld(true);
    const previews = finding?.preview ?? [];
    this.steps = previews.flatMap((preview) => this.joint(preview, previews.length > 1) ?? this.inertia(preview) ?? []);
    this.place(0);
    return this.steps.flatMap((step) => step.points);
  }

  place(part: number): void {
    this.part = part;
    for (const step of this.steps) step.place(part);
  }

  get anchors(): Anchor[] {
    return this.steps.flatMap((step) => step.anchors(this.isAfter));
  }

  /** The colour of the state that is not drawn. */
  get line(): Line {
    return !this.isAfter ? "other" : this.severity === "error" ? "error" : "warning";
  }

  get outlined(): Outlined[] {
    const { line } = this;
    return this.steps.flatMap((step) => step.other.map((mesh) => ({ mesh, line, isThrough: true })));
  }

  private joint({ joint: name, at }: Preview, isNamed: boolean): Step | null {
    const joint = name === undefined ? undefined : this.robot.joints.get(name);
    if (!joint || !at) return null;
    const before = joint.origin.matrix.clone();
    const after = matrix(at);
    const child = this.robot.links.get(joint.data.child)!;
    this.frames.add(child.data.name);
    const size = 1.1 * this.robot.unit(child);
    const glyph = placed(new Group(), new Matrix4());
    const now = placed(new Mesh(glyphs.triad, shared.glyph), scaled(before, size));
    const then = placed(new Mesh(glyphs.triad, shared.glyph), scaled(after, size));
    glyph.add(now, then);
    joint.origin.parent!.add(glyph);
    const from = new Vector3().setFromMatrixPosition(before);
    const to = new Vector3().setFromMatrixPosition(after);
    const labels: Anchor[] = [];
    const say = (text: string, where: Vector3, kind: Anchor["kind"], rank: number) => {
      const object = placed(new Object3D(), moved(where.x, where.y, where.z));
      glyph.add(object);
      labels.push({ text, object, kind, rank });
    };
    const turn = turnOf(after, before, joint.data.axis);
    const suffix = isNamed ? `, ${child.data.name}` : "";
    let tips = [from, to];
    if (Math.abs(turn.angle) >= LEAST_ANGLE) {
      this.turns = true;
      const { ends, middle, arrow } = sector(turn, 1.25 * size);
      arrow.applyMatrix4(after);
      glyph.add(
        placed(new Mesh(fan(ends), mark(COLORS.turn, 0.35)), after, ORDER.veil),
        line(edges(ends), COLORS.turn, 2.5, after),
        placed(new Mesh(arrow, mark(COLORS.turn)), new Matrix4()),
      );
      tips = [ends.at(-1)!.clone().applyMatrix4(after), ends[1]!.clone().applyMatrix4(after)];
      say(`rotated ${angle(turn.angle)}${suffix}`, middle.applyMatrix4(after), "turn", 11);
    }
    if (from.distanceTo(to) > 1e-3 * this.robot.size) {
      glyph.add(line(dashes(from, to), COLORS.after, 2.5));
      say(`moved ${length(from.distanceTo(to))}${suffix}`, from.clone().lerp(to, 0.5), "turn", 10);
    }
    say("before", tips[0]!, "frame", 9);
    say("after", tips[1]!, "ok", 9);
    const other = this.outlineOf(joint);
    joint.origin.parent!.add(other);
    other.updateMatrixWorld(true);
    glyph.updateMatrixWorld(true);
    const place = (part: number) => {
      this.robot.mount(joint, between(before, after, part));
      other.matrix.copy(part > 0.5 ? before : after);
      now.geometry = part > 0.5 ? glyphs.thinTriad : glyphs.triad;
      then.geometry = part > 0.5 ? glyphs.triad : glyphs.thinTriad;
    };
    place(1);
    this.robot.root.updateMatrixWorld(true);
    const points = [positionOf(now), positionOf(then), ...corners(child)];
    place(0);
    return {
      place,
      anchors: () => labels,
      other: other.children as Mesh[],
      points,
      remove: () => {
        glyph.removeFromParent();
        other.removeFromParent();
      },
    };
  }

  /** What the joint holds, to be outlined where it is not. */
  private outlineOf(joint: JointNode): Group {
    const group = placed(new Group(), new Matrix4());
    const back = joint.origin.matrixWorld.clone().invert();
    for (const link of this.robot.subtree(joint.data.child)) {
      for (const { mesh } of link.bodies) {
        const copy = placed(new Mesh(mesh.geometry, shared.depth), back.clone().multiply(mesh.matrixWorld));
        copy.layers.disableAll();
        group.add(copy);
      }
    }
    return group;
  }

  private inertia({ link: name, inertia, com }: Preview): Step | null {
    const link = name === undefined ? undefined : this.robot.links.get(name);
    if (!link || !inertia || inertia.impossible !== undefined) return null;
    this.inertias.add(link.data.name);
    const then = body(inertia, "box", COLORS.after);
    const now = this.bodyNow(link);
    const moves = com ? this.comThen(link, com) : null;
    if (moves) {
      this.coms = true;
      link.frame.add(moves.glyph, moves.ball);
    }
    const pale = [link.data.inertia, inertia].map((each, i) =>
      each && each.impossible === undefined ? line(dashed(each.box), i ? COLORS.after : COLORS.box, 1.75, matrix(each.at)) : new Object3D());
    link.frame.add(now, then, ...pale);
    const impossible = link.data.inertia?.impossible;
    this.broken ||= impossible !== undefined;
    const labels: [Anchor, Anchor] = [
      impossible === undefined
        ? { text: `${link.data.name}, before`, object: now, kind: "frame", rank: 9 }
        : { text: `${link.data.name}: no real body`, title: impossible, object: now, kind: "error", rank: 9 },
      { text: `${link.data.name}, after`, object: then, kind: "ok", rank: 9 },
    ];
    return {
      place: (part) => {
        now.visible = pale[1]!.visible = part <= 0.5;
        then.visible = pale[0]!.visible = part > 0.5;
        if (moves) moves.ball.visible = part > 0.5;
      },
      anchors: (after) => [labels[after ? 1 : 0], ...(moves?.labels ?? [])],
      other: [],
      points: [],
      remove: () => {
        for (const object of [now, then, ...pale, ...(moves ? [moves.glyph, moves.ball] : [])]) object.removeFromParent();
      },
    };
  }

  /** The ball of the COM where a repair puts it, and the way there. */
  private comThen(link: LinkNode, com: number[]): { glyph: Group; ball: Mesh; labels: Anchor[] } {
    const to = new Vector3(...com);
    const ball = placed(new Mesh(glyphs.ball, shared.glyph), scaled(moved(to.x, to.y, to.z), ballRadius(link.data.mass ?? 0, this.robot.size)));
    const glyph = placed(new Group(), new Matrix4());
    const from = link.data.com && new Vector3(...link.data.com);
    if (!from || from.distanceTo(to) <= 1e-3 * this.robot.size) return { glyph, ball, labels: [] };
    const middle = from.clone().lerp(to, 0.5);
    const object = placed(new Object3D(), moved(middle.x, middle.y, middle.z));
    glyph.add(line(dashes(from, to), COLORS.after, 2.5), object);
    return { glyph, ball, labels: [{ text: `COM moved ${length(from.distanceTo(to))}`, object, kind: "turn", rank: 8 }] };
  }

  private bodyNow(link: LinkNode): Object3D {
    const now: Inertia | null = link.data.inertia;
    if (!now) return new Object3D();
    if (now.impossible === undefined) return body(now, "box", COLORS.box);
    const [x, y, z] = now.com ?? link.data.com ?? [0, 0, 0];
    return line(brokenBox(0.8 * this.robot.unit(link)), COLORS.broken, 2.5, moved(x!, y!, z!));
  }
}

/** The rotation between two frames: about `axis` where it is one about it, else about an axis that makes it positive. */
export interface Turn {
  axis: Vector3;
  angle: number;
}

/** How `to` is rotated as seen in `from`. */
export function turnOf(from: Matrix4, to: Matrix4, axis: number[] | null): Turn {
  const { x, y, z, w } = new Quaternion().setFromRotationMatrix(from.clone().invert().multiply(to)).normalize();
  const sine = Math.hypot(x, y, z);
  const turned = 2 * Math.atan2(sine, Math.abs(w));
  const own = sine > 0 ? new Vector3(x, y, z).multiplyScalar(Math.sign(w || 1) / sine) : new Vector3(0, 0, 1);
  const wanted = axis && new Vector3(...axis).normalize();
  if (!wanted || Math.abs(wanted.dot(own)) < 0.9999) return { axis: own, angle: turned };
  return { axis: wanted, angle: turned * Math.sign(wanted.dot(own)) };
}

/** A sector of a circle from the nearest axis across: its middle and the points on its arc, and an arrow at its end. */
function sector({ axis, angle: turned }: Turn, radius: number): { ends: Vector3[]; middle: Vector3; arrow: ConeGeometry } {
  const units = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
  const nearest = units.reduce((a, b) => (Math.abs(a.dot(axis)) <= Math.abs(b.dot(axis)) ? a : b));
  const start = nearest.clone().addScaledVector(axis, -nearest.dot(axis)).normalize().multiplyScalar(radius);
  const at = (part: number) => start.clone().applyAxisAngle(axis, part * turned);
  const count = Math.max(6, Math.ceil(Math.abs(turned) / 0.1));
  const arc = Array.from({ length: count + 1 }, (_, i) => at(i / count));
  // As long as the arc at most, with its tip at the end of the arc.
  const tall = Math.min(0.16 * radius, 0.6 * radius * Math.abs(turned));
  const arrow = new ConeGeometry(0.4 * tall, tall, 16).translate(0, -tall / 2, 0);
  const ahead = axis.clone().cross(arc.at(-1)!).multiplyScalar(Math.sign(turned)).normalize();
  arrow.applyQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), ahead));
  const end = arc.at(-1)!;
  arrow.translate(end.x, end.y, end.z);
  return { ends: [new Vector3(), ...arc], middle: at(0.5), arrow };
}

/** The segments around points. */
function edges(points: Vector3[]): number[] {
  return points.flatMap((point, i) => [...point.toArray(), ...points[(i + 1) % points.length]!.toArray()]);
}

/** The edges of a box, each in dashes. */
function dashed(size: number[]): number[] {
  const ends = boxEdges(size);
  const all: number[] = [];
  for (let i = 0; i < ends.length; i += 6) {
    all.push(...dashes(new Vector3().fromArray(ends, i), new Vector3().fromArray(ends, i + 3), 7));
  }
  return all;
}

function between(a: Matrix4, b: Matrix4, part: number): Matrix4 {
  if (part === 0 || part === 1) return part ? b : a;
  const [from, to] = [a, b].map((at) => {
    const place = { position: new Vector3(), turn: new Quaternion(), scale: new Vector3() };
    at.decompose(place.position, place.turn, place.scale);
    return place;
  });
  return new Matrix4().compose(from!.position.lerp(to!.position, part), from!.turn.slerp(to!.turn, part), from!.scale);
}

function corners(link: LinkNode): Vector3[] {
  if (link.box.isEmpty()) return [];
  const box = link.box.clone().applyMatrix4(link.frame.matrixWorld);
  return [box.min, box.max];
}
