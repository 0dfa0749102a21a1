// A moving picture without a control, for work on the page only: `npm run dev`, then /?mock. It is not in the bundle.
import type { Status, Feature, Hole, Segment } from '../control/model';
import { control } from '../control/control.svelte';
import { cut } from '../control/cut.svelte';
import { loaded } from '../control/program.svelte';
import { machine } from '../control/machine.svelte';

const xs = [12, 44, 76, 108, 108, 76, 44, 12, 12, 44, 76, 108];
const ys = [12, 12, 12, 12, 40, 40, 40, 40, 68, 68, 68, 68];

const answers: Record<string, unknown> = {
  '/api/v1/offsets': [{ work_offset: 'G54', is_active: true, axes: { X: -250, Y: -200.4, Z: -299.981 } }, { work_offset: 'G55', is_active: false, axes: { X: 0, Y: 0, Z: 0 } }],
  '/api/v1/tools': [1, 2, 3].map((number) => ({ number, description: ['Centre drill', 'Drill 5 mm', 'Tap M6 6H'][number - 1], kind: ['drill', 'drill', 'tap'][number - 1], length_mm: 100 + number, diameter_mm: number * 2, wear_length_mm: 0, wear_radius_mm: -0.01 })),
  '/api/v1/alarms': [
    { number: 201, text: 'Y: following error of 2.4 mm, 2.0 mm are allowed', remedy: 'See what holds the axis, then reset.', program: 'plate-12xM6.ngc', line: 17, time_s: 12.3, is_cleared: true },
    { number: 105, text: 'the encoder of spindle 0 says nothing', remedy: 'Look at its cable, then reset.', program: 'plate-12xM6.ngc', line: 27, time_s: 81.9, is_cleared: false },
  ],
  '/api/v1/programs': { programs: [{ path: 'plate-12xM6.ngc', bytes: 800, modified_s: 1 }, { path: 'flange/bolt-circle.ngc', bytes: 15000, modified_s: 1 }], is_shortened: false },
};

function answer(): void {
  const real = window.fetch.bind(window);
  window.fetch = (input, init) => {
    const path = String(input);
    if (path in answers) return Promise.resolve(Response.json(answers[path]));
    if (path.startsWith('/api/v1/programs/')) return Promise.resolve(new Response(loaded.program?.text ?? ''));
    return path.startsWith('/api/v1/') ? Promise.resolve(Response.json({ accepted: false, reason: 'this is a mock', remedy: null }, { status: 409 })) : real(input, init);
  };
}

export function mock(): void {
  answer();
  const how = new URLSearchParams(location.search).get('mock');
  const holes: Hole[] = xs.map((x, i) => ({ line: 10 + i, kind: 'tap', at: [x, ys[i] ?? 0, 0], bottom: -20 }));
  const segments: Segment[] = holes.flatMap((hole, i) => {
    const [x = 0, y = 0] = hole.at;
    const from = holes[i - 1]?.at ?? [0, 0];
    return [
      { line: hole.line, kind: 'rapid', points: [[from[0] ?? 0, from[1] ?? 0, 5], [x, y, 5]] },
      { line: hole.line, kind: 'tap', points: [[x, y, 5], [x, y, -20], [x, y, 5]] },
    ];
  });
  machine.facts = {
    name: 'tapping-center', description: '', stock: { material: 'C45', bore_mm: 0, from: [0, 0, -25], to: [120, 80, 0] }, is_lathe: false, period_s: 0.00025, spindles: [], requests: [],
    axes: ['X', 'Y', 'Z'].map((letter) => ({ letter, kind: 'linear', approach_per_min: 3000, unit: 'mm' as const, travel_from: letter === 'Z' ? -400 : -500, travel_to: 0, rapid_per_min: 50000 })),
    signals: ['X.setpoint_mm', 'X.position_mm', 'Z.setpoint_mm', 'Z.position_mm', 'spindle0.ordered_rpm', 'spindle0.angle_deg', 'sync_error_um'],
    overrides: { feed: { least_percent: 0, most_percent: 200 }, rapid: { least_percent: 0, most_percent: 100 }, spindle: { least_percent: 50, most_percent: 120 } },
  };
  const text = ['(Plate: 12 x M6)', 'G21 G17 G40 G49 G80 G90', 'T3 M6', 'G43 H3', 'S6000 M3', 'G0 X12 Y12 Z30', 'G99 G84 X12 Y12 Z-20 R5 F6000', ...xs.map((x, i) => `X${x} Y${ys[i]}`), 'G80', 'M30'].join('\n');
  loaded.show({ name: 'plate-12xM6.ngc', text, segments, holes, is_shortened: false });
  cut.features = xs.slice(0, 7).map((x, i): Feature => ({ op: i, duration_s: 1, line: 10 + i, kind: 'thread', verdict: i === 5 ? 'not_judged' : 'good', reason: null, tool: 3, time_s: i, position: [x - 250, (ys[i] ?? 0) - 250], depth_mm: 20.013, depth_error_um: 13, sync_error_max_um: 1.4 + i / 10, class: '6H', margin_um: 41 }));
  cut.last = 'line 16: thread: good';
  const begun = performance.now();
  setInterval(() => {
    const s = (performance.now() - begun) / 1000;
    const z = -4.25 - 8 * Math.sin(s * 3);
    const axis = (letter: string, work: number) => ({ letter, unit: 'mm' as const, machine: work - 250, work, is_homed: true, following_error: 0, load_percent: letter === 'Z' ? 62 : 8, thermal_percent: letter === 'Z' ? 31 : 2, to_go: letter === 'Z' ? -20 - z : 0 });
    const status: Status = {
      time_s: s, emergency_stop: 'ARMED', power: 'ON', is_ready: true, mode: 'AUTOMATIC', execution: 'ACTIVE', activity: 'tapping',
      waiting_for: null, axes: [axis('X', 76), axis('Y', 40), axis('Z', z)], spindles: [{ ordered_rpm: 6000, angle_deg: (s * 1000) % 360, measured_rpm: 5998, torque_n_m: 4.6, load_percent: 23, thermal_percent: 9 }],
      tool: 3, work_offset: 'G54', codes: ['G0', 'G17', 'G21', 'G90', 'G94', 'G54', 'G43', 'G80', 'M3', 'M8'], flood: true, mist: false,
      overrides: { feed_percent: 100, rapid_percent: 50, spindle_percent: 100, is_locked: true },
      program: { name: 'plate-12xM6.ngc', line: 14, planned_s: 62, elapsed_s: s, left_s: Math.max(0, 62 - s), ahead_s: 0.5 }, sync_error_um: -0.4 + Math.sin(s * 9), is_tool_in_work: true,
      features: { good: 6, failed: 0, not_judged: 1 }, workpiece: { number: 1, name: null, programs: 1, is_ended: false, unlisted: 0 }, alarms: [], path_mm_per_min: 0, switches: { single_block: false, optional_stop: false, block_skip: [] }, unmet: ['program_waits_for_confirmation', ...(how ? ['program_under_way'] : [])].map((need) => ({ need, reason: 'this is a mock', remedy: null })),
    };
    if (how === 'stuck') Object.assign(status, { execution: 'STOPPED', activity: 'idle', sync_error_um: -3.2, alarms: ['the encoder of spindle 0 says nothing'] });
    if (how === 'manual') Object.assign(status, { execution: 'READY', mode: 'MANUAL', activity: 'idle', sync_error_um: null, is_tool_in_work: false });
    control.link = 'open';
    control.take({ type: 'status', status });
    cut.take({ type: 'status' });
  }, 20);
}
