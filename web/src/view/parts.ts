// What stands in the picture: stock, grid, holes, what is chosen; and which part of the path a touch means.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, CircleGeometry, Color, CylinderGeometry, DoubleSide, EdgesGeometry, GridHelper, InstancedMesh,
  LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, Vector3, type Camera, type Object3D,
} from 'three';
import { color } from '../theme/colors';
import type { MapHole } from '../control/holes';
import type { PathArrays } from './path';

export interface Stock { least: number[]; most: number[] }

/** A touch means what is this near to it, px. */
const touch_px = 14;

export function stockParts({ least, most }: Stock): Object3D[] {
  const size = [0, 1, 2].map((axis) => Math.max(0.01, (most[axis] ?? 0) - (least[axis] ?? 0)));
  const box = new BoxGeometry(size[0], size[1], size[2]);
  const at = new Vector3(...[0, 1, 2].map((axis) => ((most[axis] ?? 0) + (least[axis] ?? 0)) / 2));
  const solid = new Mesh(box, new MeshLambertMaterial({ color: color('stock'), transparent: true, opacity: 0.28, depthWrite: false }));
  const edges = new LineSegments(new EdgesGeometry(box), new LineBasicMaterial({ color: color('stock') }));
  for (const part of [solid, edges]) part.position.copy(at);
  return [solid, edges];
}

/** A bar that is turned about Z: X is its radius. */
export function barParts({ least, most }: Stock): Object3D[] {
  const radius = Math.max(0.01, Math.abs(most[0] ?? 0), Math.abs(least[0] ?? 0));
  const [from, to] = [least[2] ?? 0, most[2] ?? 0];
  const bar = new CylinderGeometry(radius, radius, Math.max(0.01, to - from), 48).rotateX(Math.PI / 2);
  const solid = new Mesh(bar, new MeshLambertMaterial({ color: color('stock'), transparent: true, opacity: 0.28, depthWrite: false }));
  const edges = new LineSegments(new EdgesGeometry(bar, 30), new LineBasicMaterial({ color: color('stock') }));
  for (const part of [solid, edges]) part.position.set(0, 0, (from + to) / 2);
  return [solid, edges];
}

export const colorOfKind = (kind: string): Color => new Color(color(`path-${kind}`) || color('path-feed'));

export const colorOfName = (name: string): Color => new Color(color(name));

/** The colour at a share, 0 to 1, of the scale from --scale-1 to --scale-5. */
export function colorsOfScale(): (share: number) => Color {
  const stops = [1, 2, 3, 4, 5].map((step) => new Color(color(`scale-${step}`)));
  return (share) => {
    const at = Math.min(1, Math.max(0, share)) * (stops.length - 1);
    const low = Math.min(stops.length - 2, Math.floor(at));
    return new Color().lerpColors(stops[low] as Color, stops[low + 1] as Color, at - low);
  };
}

/** A grid of 10 mm under the work. */
export function gridUnder(least: number[], most: number[]): GridHelper {
  const wide = (axis: number) => (most[axis] ?? 0) - (least[axis] ?? 0);
  const size = Math.ceil(Math.max(wide(0), wide(1), 20) / 50 + 1) * 50;
  const grid = new GridHelper(size, size / 10, color('scene-grid'), color('scene-grid'));
  grid.rotateX(Math.PI / 2);
  const middle = (axis: number) => Math.round(((least[axis] ?? 0) + (most[axis] ?? 0)) / 20) * 10;
  grid.position.set(middle(0), middle(1), (least[2] ?? 0) - 0.2);
  return grid;
}

/** Holes in the colour of their verdict. */
export function discsOf(holes: MapHole[], radius: number): InstancedMesh {
  const discs = new InstancedMesh(new CircleGeometry(1, 24), new MeshBasicMaterial({ side: DoubleSide }), Math.max(1, holes.length));
  discs.name = 'holes';
  discs.count = holes.length;
  const names = { good: 'good', failed: 'failed', not_judged: 'not-judged', none: 'path-done' };
  holes.forEach((hole, index) => {
    discs.setMatrixAt(index, new Matrix4().makeScale(radius, radius, 1).setPosition(hole.x, hole.y, 0.1));
    discs.setColorAt(index, new Color(color(names[hole.verdict])));
  });
  return discs;
}

/** The pairs of a line, drawn over everything. */
export function pairsOf(path: PathArrays, line: number): LineSegments {
  const chosen: number[] = [];
  path.lines.forEach((of, pair) => { if (of === line) chosen.push(...path.points.subarray(pair * 6, pair * 6 + 6)); });
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(chosen), 3));
  const marked = new LineSegments(geometry, new LineBasicMaterial({ color: color('text'), depthTest: false }));
  marked.name = 'marked';
  marked.renderOrder = 2;
  return marked;
}

/** The pair of the path nearest to a point of the canvas, if it is near. */
export function nearestPair(path: PathArrays, camera: Camera, canvas: HTMLCanvasElement, x: number, y: number): number | null {
  const seen = (index: number) => {
    const at = new Vector3().fromArray(path.points, index).project(camera);
    return [((at.x + 1) / 2) * canvas.clientWidth, ((1 - at.y) / 2) * canvas.clientHeight] as const;
  };
  let best: number | null = null;
  let nearest = touch_px;
  for (let pair = 0; pair < path.lines.length; pair++) {
    const [a, b] = [seen(pair * 6), seen(pair * 6 + 3)];
    const length = (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2;
    const along = length > 0 ? Math.min(1, Math.max(0, ((x - a[0]) * (b[0] - a[0]) + (y - a[1]) * (b[1] - a[1])) / length)) : 0;
    const distance = Math.hypot(x - a[0] - along * (b[0] - a[0]), y - a[1] - along * (b[1] - a[1]));
    if (distance < nearest) [nearest, best] = [distance, pair];
  }
  return best;
}
