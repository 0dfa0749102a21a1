// The picture: path, holes, stock and tool in 3-D. It draws when something has changed and never else.
import {
  AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, CircleGeometry, Color, CylinderGeometry, DirectionalLight,
  DoubleSide, EdgesGeometry, GridHelper, Group, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, OrthographicCamera, Scene, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { color } from '../theme/colors';
import type { MapHole } from '../control/holes';
import type { PathArrays } from './path';

export type ViewName = 'top' | 'front' | 'side' | 'iso';
export interface Stock { least: number[]; most: number[] }

/** Pictures follow one another by so much at least, and take a fifth of the time at most: the digits come first. */
const least_ms = 33;

export class PathScene {
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new OrthographicCamera(-1, 1, 1, -1, -5000, 5000);
  readonly #controls: OrbitControls;
  readonly #drawn = new Group();
  readonly #tool: Mesh;
  #toCome = new BufferGeometry();
  #done = new BufferGeometry();
  #path: PathArrays | null = null;
  #least: number[] = [];
  #most: number[] = [];
  #isAsked = false;
  #next_ms = 0;
  #name: ViewName = 'iso';
  readonly isLathe: boolean;

  constructor(readonly canvas: HTMLCanvasElement, isLathe: boolean) {
    this.isLathe = isLathe;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: 'low-power' });
    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enableDamping = false;
    this.#controls.addEventListener('change', () => this.draw());
    this.#tool = new Mesh(new CylinderGeometry(1, 1, 8, 24), new MeshLambertMaterial());
    this.#tool.geometry.rotateX(Math.PI / 2).translate(0, 0, 4);
    const light = new DirectionalLight(0xffffff, 2);
    light.position.set(-1, -2, 4);
    this.#scene.add(new AmbientLight(0xffffff, 1.4), light, this.#drawn, this.#tool);
  }

  /** A new program; also after the colours have changed. */
  show(path: PathArrays, stock: Stock | null): void {
    this.#path = path;
    this.#least = path.least.map((value, axis) => Math.min(value, stock?.least[axis] ?? value));
    this.#most = path.most.map((value, axis) => Math.max(value, stock?.most[axis] ?? value));
    this.#drawn.clear();
    const colors = new Float32Array(path.points.length);
    const palette = new Map<string, Color>();
    path.kinds.forEach((kind, pair) => {
      const of = palette.get(kind) ?? new Color(color(`path-${kind}`) || color('path-feed'));
      palette.set(kind, of);
      for (let end = 0; end < 2; end++) of.toArray(colors, pair * 6 + end * 3);
    });
    const position = new BufferAttribute(path.points, 3);
    this.#toCome = new BufferGeometry().setAttribute('position', position).setAttribute('color', new BufferAttribute(colors, 3));
    this.#done = new BufferGeometry().setAttribute('position', position);
    this.#drawn.add(
      new LineSegments(this.#done, new LineBasicMaterial({ color: color('path-done') })),
      new LineSegments(this.#toCome, new LineBasicMaterial({ vertexColors: true })),
    );
    if (stock) this.#addStock(stock);
    this.#scene.background = new Color(color('scene'));
    (this.#tool.material as MeshLambertMaterial).color.set(color('tool'));
    this.#addGrid(path);
    this.progress(0);
  }

  #addStock({ least, most }: Stock): void {
    const size = [0, 1, 2].map((axis) => Math.max(0.01, (most[axis] ?? 0) - (least[axis] ?? 0)));
    const box = new BoxGeometry(size[0], size[1], size[2]);
    const at = new Vector3(...[0, 1, 2].map((axis) => ((most[axis] ?? 0) + (least[axis] ?? 0)) / 2));
    const solid = new Mesh(box, new MeshLambertMaterial({ color: color('stock'), transparent: true, opacity: 0.28, depthWrite: false }));
    const edges = new LineSegments(new EdgesGeometry(box), new LineBasicMaterial({ color: color('stock') }));
    for (const part of [solid, edges]) { part.position.copy(at); this.#drawn.add(part); }
  }

  #addGrid(path: PathArrays): void {
    if (this.isLathe || !Number.isFinite(path.least[0])) return;
    const size = Math.ceil(Math.max(path.most[0] - path.least[0], path.most[1] - path.least[1], 20) / 50 + 1) * 50;
    const grid = new GridHelper(size, size / 10, color('scene-grid'), color('scene-grid'));
    grid.rotateX(Math.PI / 2);
    const middle = (axis: 0 | 1) => Math.round((path.least[axis] + path.most[axis]) / 20) * 10;
    grid.position.set(middle(0), middle(1), (this.#least[2] ?? 0) - 0.2);
    this.#drawn.add(grid);
  }

  /** Holes in the colour of their verdict. */
  holes(holes: MapHole[], radius: number): void {
    const old = this.#scene.getObjectByName('holes');
    if (old) this.#scene.remove(old);
    const discs = new InstancedMesh(new CircleGeometry(1, 24), new MeshBasicMaterial({ side: DoubleSide }), Math.max(1, holes.length));
    discs.name = 'holes';
    discs.count = holes.length;
    const names = { good: 'good', failed: 'failed', not_judged: 'not-judged', none: 'path-done' };
    holes.forEach((hole, index) => {
      discs.setMatrixAt(index, new Matrix4().makeScale(radius, radius, 1).setPosition(hole.x, hole.y, 0.1));
      discs.setColorAt(index, new Color(color(names[hole.verdict])));
    });
    this.#scene.add(discs);
    this.draw();
  }

  progress(pair: number): void {
    const all = this.#path?.lines.length ?? 0;
    this.#done.setDrawRange(0, pair * 2);
    this.#toCome.setDrawRange(pair * 2, (all - pair) * 2);
    this.draw();
  }

  tool(at: readonly number[], diameter: number): void {
    const radius = Math.max(0.5, diameter / 2);
    this.#tool.position.set(at[0] ?? 0, at[1] ?? 0, at[2] ?? 0);
    this.#tool.scale.set(radius, radius, Math.max(radius, 3));
    this.draw();
  }

  /** Looks from one of the standard directions at the whole path. */
  look(name: ViewName): void {
    this.#name = name;
    const path = this.#path;
    if (!path || !Number.isFinite(path.least[0])) return;
    const middle = new Vector3(...[0, 1, 2].map((axis) => ((this.#least[axis] ?? 0) + (this.#most[axis] ?? 0)) / 2));
    const from = { top: [0, 0, 1], front: [0, -1, 0], side: [1, 0, 0], iso: [-0.6, -1, 0.8] }[name];
    const direction = this.isLathe ? [0, -1, 0] : from;
    // A lathe has Z horizontal and X upward.
    const [x, y, z] = this.isLathe ? [1, 0, 0] : name === 'top' ? [0, 1, 0] : [0, 0, 1];
    this.#camera.up.set(x ?? 0, y ?? 0, z ?? 0);
    this.#camera.position.copy(middle).add(new Vector3(...direction).multiplyScalar(1000));
    this.#controls.target.copy(middle);
    this.#camera.zoom = 1;
    this.#camera.lookAt(middle);
    this.#frame();
    this.#controls.update();
    this.draw();
  }

  #frame(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const path = this.#path;
    if (!path || width === 0 || height === 0) return;
    this.#camera.updateMatrixWorld();
    const inverse = this.#camera.matrixWorldInverse;
    let [wide, high] = [1, 1];
    for (let corner = 0; corner < 8; corner++) {
      const point = new Vector3(...[0, 1, 2].map((axis) => ((corner >> axis) & 1 ? this.#most : this.#least)[axis] ?? 0)).applyMatrix4(inverse);
      wide = Math.max(wide, Math.abs(point.x));
      high = Math.max(high, Math.abs(point.y));
    }
    const half = Math.max(high, (wide * height) / width) * 1.12;
    const aspect = width / height;
    Object.assign(this.#camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    this.#camera.updateProjectionMatrix();
  }

  resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#renderer.setSize(width, height, false);
    this.look(this.#name);
  }

  /** The pair of the path nearest to a point of the canvas, within 14 px. */
  pick(x: number, y: number): number | null {
    const path = this.#path;
    if (!path) return null;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const seen = (index: number) => {
      const at = new Vector3().fromArray(path.points, index).project(this.#camera);
      return [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height] as const;
    };
    let best: number | null = null;
    let nearest = 14;
    for (let pair = 0; pair < path.lines.length; pair++) {
      const [a, b] = [seen(pair * 6), seen(pair * 6 + 3)];
      const length = (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2;
      const along = length > 0 ? Math.min(1, Math.max(0, ((x - a[0]) * (b[0] - a[0]) + (y - a[1]) * (b[1] - a[1])) / length)) : 0;
      const distance = Math.hypot(x - a[0] - along * (b[0] - a[0]), y - a[1] - along * (b[1] - a[1]));
      if (distance < nearest) [nearest, best] = [distance, pair];
    }
    return best;
  }

  /** Marks the pairs of a line. */
  mark(line: number | null): void {
    const old = this.#scene.getObjectByName('marked');
    if (old) this.#scene.remove(old);
    const path = this.#path;
    if (path && line !== null) {
      const chosen: number[] = [];
      path.lines.forEach((of, pair) => { if (of === line) chosen.push(...path.points.subarray(pair * 6, pair * 6 + 6)); });
      const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(chosen), 3));
      const marked = new LineSegments(geometry, new LineBasicMaterial({ color: color('text'), depthTest: false }));
      marked.name = 'marked';
      marked.renderOrder = 2;
      this.#scene.add(marked);
    }
    this.draw();
  }

  draw(): void {
    if (this.#isAsked) return;
    this.#isAsked = true;
    const render = () => requestAnimationFrame(() => {
      this.#isAsked = false;
      const begun = performance.now();
      this.#renderer.render(this.#scene, this.#camera);
      this.#next_ms = begun + Math.max(least_ms, 4 * (performance.now() - begun));
    });
    setTimeout(render, Math.max(0, this.#next_ms - performance.now()));
  }

  free(): void {
    this.#controls.dispose();
    this.#renderer.dispose();
  }
}
