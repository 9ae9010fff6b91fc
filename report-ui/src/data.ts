// What the report hands over in <script id="uc-data">: written by urdfcheck/output/html/viewer/scene_data.py.
// Lengths in metres, angles in radians, 4x4 transforms row-major.

export type Severity = "error" | "warning" | "info" | "";
export type Layer = (typeof LAYERS)[number];
export const LAYERS = [
  "visual", "collision", "com", "box", "ellipsoid", "axes", "frames", "holes", "overlaps", "ground", "preview",
] as const;

export interface Shape {
  at: number[];
  color: number[] | null;
  mesh?: number;
  scale?: number[];
  box?: number[];
  cylinder?: number[];
  sphere?: number[];
  capsule?: number[];
}

/** Axes and size of the body that has this inertia, or why there is none. */
export type Inertia =
  | { at: number[]; principal: number[]; box: number[]; ellipsoid: number[]; impossible?: undefined }
  | { impossible: string; com: number[] | null };

export interface Link {
  name: string;
  severity: Severity;
  at: number[] | null;
  visual: Shape[];
  collision: Shape[];
  mass: number | null;
  com: number[] | null;
  inertia: Inertia | null;
}

export interface Joint {
  name: string;
  type: string;
  severity: Severity;
  parent: string;
  child: string;
  at: number[];
  axis: number[] | null;
  lower: number | null;
  upper: number | null;
  start: number;
  mimic: { joint: string; multiplier: number; offset: number } | null;
}

export interface Preview {
  joint?: string;
  at?: number[];
  link?: string;
  inertia?: Inertia | null;
  com?: number[] | null;
}

export interface Finding {
  id: string;
  code: string;
  severity: Severity;
  links: string[];
  joints: string[];
  /** Those that it compares them with or refers to: they are shown, but have no defect. */
  beside?: { links: string[]; joints: string[] };
  layers: Layer[];
  preview: Preview[];
  /** Of a change: the links as the first version calls them, in the order of `links`; a name that is empty has no counterpart. */
  before?: string[];
  /** The joint positions at which it is seen best. */
  pose?: Record<string, number>;
  /** Whether it is seen best beside all of the robot. */
  whole?: boolean;
  /** Whether it is inside of the parts it is about: only what collides is solid then. */
  inside?: boolean;
  /** Whether only the first of two versions has it. */
  gone?: boolean;
}

export interface ModelData {
  id: string;
  name: string;
  root: string;
  links: Link[];
  joints: Joint[];
  frames: { parent: string; child: string; at: number[] }[];
  overlaps: { a: string; b: string; points: number[][]; depth: number | null; finding: string | null }[];
  ground: null | { height: number; contacts: { link: string; point: number[] }[]; support: number[][]; com: number[]; stands: boolean };
  findings: Finding[];
  /** What is not drawn because its mesh is missing or was not read, in words; empty where all is. */
  undrawn: string;
  /** The version that it is compared with, and the pose of that one's root here: the two may have different roots. */
  before?: ModelData;
  beforeAt?: number[];
  /** What has another name there: that name, by the name here. */
  renamed?: { links: Record<string, string>; joints: Record<string, string> };
}

/** Where a mesh lies in the geometry, see urdfcheck/facts/mesh/codec.py. */
export interface MeshEntry {
  offset: number;
  vertices: number;
  faces: number;
  holes: number;
  low: number[];
  high: number[];
  wide: boolean;
}

export interface Stage {
  models: ModelData[];
  meshes: MeshEntry[];
}

/** What is selected: a finding wins over a joint, a joint over a link. */
export interface Selection {
  model: string;
  link?: string;
  joint?: string;
  finding?: string;
  origin: "page" | "viewer";
}
