// Numbers of the scene for tests and curious people: `urdfcheck` on the console.
import { Vector3 } from "three";
import type { Robot } from "./robot.ts";
import type { Stage } from "./stage.ts";
import type { Versions } from "./versions.ts";

export function handleOf(stage: Stage, robotNow: () => Robot, versionsNow: () => Versions | null, moved: () => void): object {
  const link = (name: string) => {
    robotNow().root.updateMatrixWorld(true);
    return robotNow().links.get(name)!;
  };
  return {
    /** The frame of a link in the world, 4x4 row-major. */
    frame: (name: string) => link(name).frame.matrixWorld.clone().transpose().toArray(),
    /** The corners of its inertia box in the world. */
    corners: (name: string) => {
      const found: number[][] = [];
      link(name).frame.traverse((object) => {
        if (object.name !== "box") return;
        for (let i = 0; i < 8; i++) {
          const corner = new Vector3(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
          found.push(corner.applyMatrix4(object.matrixWorld).toArray());
        }
      });
      return found;
    },
    /** Where the middle of a link's shapes is in the window. */
    pixel: (name: string) => {
      const at = robotNow().boundsOf(link(name)).getCenter(new Vector3()).project(stage.camera);
      const rect = stage.canvas.getBoundingClientRect();
      return [rect.left + ((at.x + 1) / 2) * rect.width, rect.top + ((1 - at.y) / 2) * rect.height];
    },
    /** Of two versions: the frame of a link in the first, how many bodies differ in each, and which one is chosen (0 to 1). */
    frameBefore: (name: string) => versionsNow()!.before.links.get(name)!.frame.matrixWorld.clone().transpose().toArray(),
    differing: () => versionsNow()!.counts,
    part: () => versionsNow()!.part,
    set: (name: string, value: number) => { robotNow().set(name, value); moved(); },
    /** The picture as a PNG in a data URL. */
    picture: () => stage.picture(),
    software: stage.software,
  };
}
