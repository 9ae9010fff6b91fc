// A model as objects that move: links in their joints, with the shapes they are drawn by.
import { Box3, BufferGeometry, Color, Group, Matrix4, Mesh, MeshPhongMaterial, Object3D, SRGBColorSpace, Vector3 } from "three";
import type { Joint, Link, ModelData, Severity, Shape } from "./data.ts";
import { body, edge, mark, ORDER, shared } from "./materials.ts";
import type { Line, Outlined } from "./outline.ts";
import { matrix, tubes, type Shapes } from "./shapes.ts";
import type { Theme } from "./theme.ts";

const UNPAINTED = new Color(0xaab4c0);
// Deeper than in text, so that they stay what they are under light, in both themes.
const TONES: Record<Severity, Color | null> = { error: new Color(0xdf3f36), warning: new Color(0xe8981c), info: null, "": null };
const MOVES = new Set(["revolute", "continuous", "prismatic"]);

export interface Body {
  link: LinkNode;
  shape: Shape;
  mesh: Mesh<BufferGeometry, MeshPhongMaterial>;
  own: MeshPhongMaterial;
  base: Color;
  /** Writes depth only, so that a ghost does not show its inside. */
  depth: Mesh;
}

export interface LinkNode {
  data: Link;
  frame: Group;
  bodies: Body[];
  collisions: Mesh[];
  /** Of its shapes, in its own frame; empty where it has none. */
  box: Box3;
  parent: JointNode | null;
}

export interface JointNode {
  data: Joint;
  /** The joint's frame, fixed in the parent. */
  origin: Group;
  /** Moves with the joint; holds the child. */
  motion: Group;
  moves: boolean;
  value: number;
  lower: number;
  upper: number;
}

/** How links are to look. */
export interface Look {
  visual: boolean;
  collision: boolean;
  /** Links that stay solid while the others are ghosts; null when nothing is selected. */
  lit: Set<string> | null;
  /** Whether the drawn shapes of solid links are ghosts too, so that their collision shapes show. */
  sheer: boolean;
  /** What the outline of a link says, which has this severity of its own; of the selected links only, where any are. */
  outline(name: string, own: Severity): Severity | Line;
  hovered: string | null;
}

const frozen = <O extends Object3D>(object: O, at?: Matrix4): O => {
  object.matrixAutoUpdate = false;
  if (at) object.matrix.copy(at);
  return object;
};

export class Robot {
  readonly root = frozen(new Group());
  readonly links = new Map<string, LinkNode>();
  readonly joints = new Map<string, JointNode>();
  /** At the start: the bounds of all that is drawn, and the length of their diagonal. */
  readonly box = new Box3();
  readonly size: number;
  private readonly bones = mark(UNPAINTED);
  private collisionsBuilt = false;

  /** `at`: the pose of the root in the world. */
  constructor(readonly data: ModelData, private readonly shapes: Shapes, at?: number[]) {
    if (at) this.root.matrix.copy(matrix(at));
    for (const link of data.links) this.links.set(link.name, this.linkNode(link));
    const below = new Map<string, Joint[]>();
    for (const joint of data.joints) below.set(joint.parent, [...(below.get(joint.parent) ?? []), joint]);
    const placed = new Set<string>();
    const place = (name: string, holder: Object3D) => {
      const queue: [string, Object3D][] = [[name, holder]];
      for (let next = queue.shift(); next; next = queue.shift()) {
        const node = this.links.get(next[0]);
        if (!node || placed.has(next[0])) continue;
        placed.add(next[0]);
        next[1].add(node.frame);
        for (const joint of below.get(next[0]) ?? []) {
          if (!this.links.has(joint.child) || placed.has(joint.child)) continue;
          const child = this.jointNode(joint, node);
          this.links.get(joint.child)!.parent = child;
          queue.push([joint.child, child.motion]);
        }
      }
    };
    place(data.root, this.root);
    // Where the tree is broken, whatever can be placed stands where it was found.
    for (const link of data.links) {
      if (link.at && !placed.has(link.name)) {
        const holder = frozen(new Group(), matrix(link.at));
        this.root.add(holder);
        place(link.name, holder);
      }
    }
    for (const joint of this.joints.values()) this.move(joint, joint.data.start);
    for (const joint of this.joints.values()) this.follow(joint);
    this.root.updateMatrixWorld(true);
    for (const link of this.links.values()) this.box.union(this.boundsOf(link));
    const all = [...this.links.values()];
    if (all.filter((link) => !link.box.isEmpty()).length < all.length / 2) {
      for (const link of all) this.box.expandByPoint(positionOf(link.frame));
      this.buildSkeleton();
    }
    if (this.box.isEmpty()) this.box.set(new Vector3(-0.5, -0.5, 0), new Vector3(0.5, 0.5, 0.5));
    // The frame of one link alone is a point, and stands on the ground.
    else if (this.box.getSize(new Vector3()).length() === 0) this.box.expandByVector(new Vector3(0.5, 0.5, 0)).expandByPoint(this.box.max.clone().setZ(this.box.max.z + 0.5));
    this.size = Math.max(this.box.getSize(new Vector3()).length(), 1e-3);
  }

  /** The height of the ground: where it stands, or its lowest point. */
  get ground(): number {
    return this.data.ground?.height ?? this.box.min.z;
  }

  /** Lines from joint to joint, where little else is drawn. */
  private buildSkeleton(): void {
    const thin = 0.004 * this.box.getSize(new Vector3()).length();
    for (const joint of this.joints.values()) {
      const to = new Vector3().setFromMatrixPosition(joint.origin.matrix);
      if (to.length() < thin) continue;
      const bone = frozen(new Mesh(tubes([0, 0, 0, ...to.toArray()], thin, 6), this.bones), new Matrix4());
      joint.origin.parent!.add(bone);
    }
  }

  private linkNode(data: Link): LinkNode {
    const node: LinkNode = { data, frame: frozen(new Group()), bodies: [], collisions: [], box: new Box3(), parent: null };
    for (const shape of data.visual.length ? data.visual : data.collision) node.box.union(this.shapes.bounds(shape));
    for (const shape of data.visual) {
      const drawn = this.shapes.of(shape);
      if (!drawn) continue;
      const [r, g, b, a] = shape.color ?? [];
      const base = r === undefined ? UNPAINTED.clone() : new Color().setRGB(r, g, b, SRGBColorSpace);
      const own = body(base.clone(), Math.max(a ?? 1, 0.08));
      const mesh = frozen(new Mesh(drawn.geometry, own), drawn.at);
      const depth = frozen(new Mesh(drawn.geometry, shared.depth), drawn.at);
      depth.renderOrder = ORDER.ghostDepth;
      mesh.userData.link = data.name;
      node.frame.add(mesh, depth);
      node.bodies.push({ link: node, shape, mesh, own, base, depth });
    }
    return node;
  }

  private jointNode(data: Joint, parent: LinkNode): JointNode {
    const moves = MOVES.has(data.type) && data.axis !== null;
    const [lower, upper] = this.limits(data);
    const origin = frozen(new Group(), matrix(data.at));
    const motion = frozen(new Group());
    origin.add(motion);
    parent.frame.add(origin);
    const node = { data, origin, motion, moves, value: 0, lower, upper };
    this.joints.set(data.name, node);
    return node;
  }

  /** A continuous joint turns once around, and a limit that is missing is a guess. */
  private limits({ type, lower, upper }: Joint): [number, number] {
    if (type === "continuous") return [-Math.PI, Math.PI];
    const guess = type === "prismatic" ? 0.5 : Math.PI;
    const ends = [lower ?? Math.min(-guess, upper ?? 0), upper ?? Math.max(guess, lower ?? 0)];
    return [Math.min(...ends), Math.max(...ends)];
  }

  /** The joints that a person can move, in the order of the file, and those that follow. */
  get movable(): JointNode[] {
    return [...this.joints.values()].filter((joint) => joint.moves);
  }

  set(name: string, value: number): void {
    const joint = this.joints.get(name);
    if (!joint || !joint.moves || joint.data.mimic) return;
    this.move(joint, value);
    for (const other of this.joints.values()) this.follow(other);
  }

  private follow(joint: JointNode): void {
    if (joint.data.mimic && joint.moves) this.move(joint, this.followed(joint, 0));
  }

  /** The value of the joint that it follows, through followers of followers. */
  private followed(joint: JointNode, depth: number): number {
    const mimic = joint.data.mimic;
    const leader = mimic && this.joints.get(mimic.joint);
    if (!mimic || !leader || depth > this.joints.size) return joint.value;
    return mimic.multiplier * this.followed(leader, depth + 1) + mimic.offset;
  }

  private move(joint: JointNode, value: number): void {
    joint.value = value;
    if (!joint.moves) return;
    const axis = new Vector3(...joint.data.axis!);
    if (joint.data.type === "prismatic") joint.motion.matrix.makeTranslation(axis.multiplyScalar(value));
    else joint.motion.matrix.makeRotationAxis(axis.normalize(), value);
    joint.motion.matrixWorldNeedsUpdate = true;
  }

  /** Puts a joint where its parent holds it. */
  mount(joint: JointNode, at: Matrix4): void {
    joint.origin.matrix.copy(at);
    joint.origin.matrixWorldNeedsUpdate = true;
  }

  /** Whether every joint is where it was at first. */
  get neutral(): boolean {
    return this.movable.every((joint) => joint.data.mimic || Math.abs(joint.value - joint.data.start) < 1e-9);
  }

  /** Whether every joint is at zero at first: limits may exclude that, and followers may have an offset. */
  get startsAtZero(): boolean {
    return this.movable.every(({ data }) => (data.mimic ? data.mimic.offset === 0 : data.start === 0));
  }

  /** The worst that is known of a link and of the joint that places it. */
  severityOf(link: LinkNode): Severity {
    return worse(link.data.severity, link.parent?.data.severity ?? "");
  }

  /** The bounds of a link's shapes in the world. */
  boundsOf(link: LinkNode): Box3 {
    return link.box.isEmpty() ? new Box3() : link.box.clone().applyMatrix4(link.frame.matrixWorld);
  }

  /** The size of the glyphs of a link: in proportion to it, within bounds that the robot sets. */
  unit(link: LinkNode): number {
    const own = link.box.isEmpty() ? 0 : link.box.getSize(new Vector3()).length();
    return Math.min(0.09 * this.size, Math.max(0.028 * this.size, 0.42 * own));
  }

  /** The link and all that hangs on it. */
  subtree(name: string): LinkNode[] {
    const node = this.links.get(name);
    if (!node) return [];
    const found: LinkNode[] = [];
    node.frame.traverse((object) => {
      for (const link of this.links.values()) if (link.frame === object) found.push(link);
    });
    return found;
  }

  /** What can be hit: the drawn shapes, or those that collide where these are all that is shown. */
  get targets(): Mesh[] {
    const links = [...this.links.values()];
    const bodies = links.flatMap((link) => link.bodies.map(({ mesh }) => mesh)).filter((mesh) => mesh.visible);
    return bodies.length ? bodies : links.flatMap((link) => link.collisions).filter((mesh) => mesh.visible);
  }

  /** Gives everything its look, and tells what is outlined. */
  dress(look: Look, theme: Theme): Outlined[] {
    if (look.collision) this.buildCollisions();
    this.bones.color.copy(theme.soft);
    const isDrawn = [...this.links.values()].some((link) => link.bodies.length);
    const outlined: Outlined[] = [];
    for (const link of this.links.values()) {
      const { name } = link.data;
      const severity = this.severityOf(link);
      const ghost = look.lit !== null && !look.lit.has(name);
      const hovered = look.hovered === name;
      const said = look.outline(name, severity);
      const line = said === "info" || said === "" ? null : said;
      const sheer = ghost || look.sheer;
      for (const part of link.bodies) {
        part.mesh.visible = look.visual;
        part.depth.visible = look.visual && sheer;
        part.mesh.material = sheer ? shared.ghost : part.own;
        part.mesh.renderOrder = sheer ? ORDER.ghost : 0;
        const tone = hovered ? TONES[severity] : null;
        part.own.color.copy(toned(part.base, tone));
        edge(part.own, theme, tone);
        part.own.emissive.copy(theme.link).multiplyScalar(hovered && !tone ? 0.22 : 0);
        if (look.visual && !ghost) outlined.push({ mesh: part.mesh, line });
      }
      for (const mesh of link.collisions) {
        // Beside what is selected the drawn shapes are enough to tell where it is.
        mesh.visible = look.collision && !(ghost && isDrawn);
        mesh.material = ghost ? shared.collisionGhost : shared.collision;
        if (mesh.visible && !ghost && !(look.visual && link.bodies.length)) outlined.push({ mesh, line });
      }
    }
    return outlined;
  }

  private buildCollisions(): void {
    if (this.collisionsBuilt) return;
    this.collisionsBuilt = true;
    for (const link of this.links.values()) {
      for (const shape of link.data.collision) {
        const drawn = this.shapes.of(shape);
        if (!drawn) continue;
        const mesh = frozen(new Mesh(drawn.geometry, shared.collision), drawn.at);
        mesh.renderOrder = ORDER.collision;
        mesh.userData.link = link.data.name;
        link.frame.add(mesh);
        link.collisions.push(mesh);
      }
    }
  }
}

/** A link's colour, half way to that of its worst finding. Black plastic would swallow every shade. */
function toned(base: Color, tone: Color | null): Color {
  const floor = 0.028;
  const color = new Color(Math.max(base.r, floor), Math.max(base.g, floor), Math.max(base.b, floor));
  return tone ? color.lerp(tone, 0.5) : color;
}

const SEVERITIES: Severity[] = ["", "info", "warning", "error"];

export function worse(a: Severity, b: Severity): Severity {
  return SEVERITIES.indexOf(a) < SEVERITIES.indexOf(b) ? b : a;
}

export function positionOf(object: Object3D): Vector3 {
  return new Vector3().setFromMatrixPosition(object.matrixWorld);
}
