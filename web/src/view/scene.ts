// The picture: path, holes, stock and tool in 3-D. It draws when something has changed and never else.
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, Group, LineBasicMaterial, LineSegments,
  Mesh, MeshLambertMaterial, OrthographicCamera, Scene, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { color } from '../theme/colors';
import type { MapHole } from '../control/holes';
import { barParts, colorOfKind, discsOf, gridUnder, nearestPair, pairsOf, stockParts, type Stock } from './parts';
import type { PathArrays } from './path';

export { colorOfKind, colorOfName, colorsOfScale } from './parts';
export type ViewName = 'top' | 'front' | 'side' | 'iso';

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
  #at = 0;
  #isMeasured = false;
  #name: ViewName = 'iso';
  readonly isLathe: boolean;
  /** Called once, when the first picture is drawn. */
  onFirst: (() => void) | null = null;

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
    this.recolor();
  }

  recolor(): void {
    this.#scene.background = new Color(color('scene'));
    (this.#tool.material as MeshLambertMaterial).color.set(color('tool'));
    this.#tool.visible = this.#path !== null;
    this.draw();
  }

  /** A new program; also after the colours have changed. */
  show(path: PathArrays, stock: Stock | null): void {
    this.#path = path;
    // What is cut fills the picture; a stock that is much larger goes beyond its edges.
    const room = 0.08 * Math.max(...path.most.map((value, axis) => value - (path.least[axis] ?? 0)), 1);
    this.#least = path.least.map((value, axis) => Math.min(value, Math.max(value - room, stock?.least[axis] ?? value)));
    this.#most = path.most.map((value, axis) => Math.max(value, Math.min(value + room, stock?.most[axis] ?? value)));
    this.#drawn.clear();
    const position = new BufferAttribute(path.points, 3);
    const colors = new BufferAttribute(new Float32Array(path.points.length), 3);
    this.#toCome = new BufferGeometry().setAttribute('position', position).setAttribute('color', colors);
    this.#done = new BufferGeometry().setAttribute('position', position);
    this.#drawn.add(
      new LineSegments(this.#done, new LineBasicMaterial({ color: color('path-done') })),
      new LineSegments(this.#toCome, new LineBasicMaterial({ vertexColors: true })),
    );
    if (stock) this.#drawn.add(...(this.isLathe ? barParts(stock) : stockParts(stock)));
    this.paint(false, (pair) => colorOfKind(path.kinds[pair] ?? ''));
    this.recolor();
    if (!this.isLathe && Number.isFinite(path.least[0])) this.#drawn.add(gridUnder(this.#least, this.#most));
    this.progress(0);
  }

  /** Holes in the colour of their verdict. */
  holes(holes: MapHole[], radius: number): void {
    const old = this.#scene.getObjectByName('holes');
    if (old) this.#scene.remove(old);
    const discs = discsOf(holes, radius);
    this.#scene.add(discs);
    this.draw();
  }

  /** Colours each pair of the path; where they say what was measured, what is done is not grey. */
  paint(isMeasured: boolean, of: (pair: number) => Color): void {
    const colors = this.#toCome.getAttribute('color') as BufferAttribute | undefined;
    if (!colors || !this.#path) return;
    this.#isMeasured = isMeasured;
    for (let pair = 0; pair < this.#path.lines.length; pair++) {
      const { r, g, b } = of(pair);
      colors.setXYZ(pair * 2, r, g, b).setXYZ(pair * 2 + 1, r, g, b);
    }
    colors.needsUpdate = true;
    this.progress(this.#at);
  }

  progress(pair: number): void {
    this.#at = pair;
    const all = this.#path?.lines.length ?? 0;
    const done = this.#isMeasured ? 0 : pair;
    this.#done.setDrawRange(0, done * 2);
    this.#toCome.setDrawRange(done * 2, (all - done) * 2);
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
    // A lathe is seen with its chuck on the left: Z to the right, X upward.
    const direction = this.isLathe ? [0, 1, 0] : from;
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
    const half = Math.max(high, (wide * height) / width) * 1.06;
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
    return nearestPair(path, this.#camera, this.canvas, x, y);
  }

  /** Marks the pairs of a line. */
  mark(line: number | null): void {
    const old = this.#scene.getObjectByName('marked');
    if (old) this.#scene.remove(old);
    const path = this.#path;
    if (path && line !== null) {
      const marked = pairsOf(path, line);
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
      this.onFirst?.();
      this.onFirst = null;
      this.#next_ms = begun + Math.max(least_ms, 4 * (performance.now() - begun));
    });
    setTimeout(render, Math.max(0, this.#next_ms - performance.now()));
  }

  free(): void {
    this.#controls.dispose();
    this.#renderer.dispose();
  }
}
