// What the control says of itself, as the API sends it: plain values with their units in their names.
export interface AxisStatus {
  letter: string;
  unit: 'mm' | 'deg';
  machine: number;
  work: number;
  to_go?: number | null;
  is_homed: boolean;
  following_error: number;
}
export interface SpindleStatus {
  ordered_rpm: number;
  rpm?: number;
  angle_deg: number;
  load_percent?: number | null;
}
export interface Overrides {
  feed_percent: number;
  rapid_percent: number;
  spindle_percent: number;
  is_locked: boolean;
}
export interface WaitingStatus { what: string; age_s: number; limit_s: number | null }
export interface ProgramStatus { name: string; line: number; planned_s: number; elapsed_s: number }
export interface FeatureCount { good: number; failed: number; not_judged: number }
export type Execution =
  | 'READY' | 'ACTIVE' | 'WAIT' | 'FEED_HOLD' | 'INTERRUPTED' | 'OPTIONAL_STOP'
  | 'PROGRAM_STOPPED' | 'PROGRAM_COMPLETED' | 'STOPPED';
export interface Status {
  time_s: number;
  emergency_stop: 'ARMED' | 'TRIGGERED';
  power: 'OFF' | 'ON';
  is_ready: boolean;
  mode: 'AUTOMATIC' | 'MANUAL_DATA_INPUT' | 'MANUAL';
  execution: Execution;
  activity: string;
  waiting_for: WaitingStatus | null;
  axes: AxisStatus[];
  spindles: SpindleStatus[];
  tool: number | null;
  work_offset: string;
  codes: string[];
  overrides: Overrides;
  program: ProgramStatus | null;
  sync_error_um: number | null;
  is_tool_in_work: boolean;
  features: FeatureCount;
  alarms: string[];
}

export interface MachineAxis { letter: string; unit: 'mm' | 'deg'; travel_from: number; travel_to: number; rapid_per_min?: number; approach_per_min?: number }
export interface Range { least_percent: number; most_percent: number }
export interface Machine {
  name: string;
  description: string;
  axes: MachineAxis[];
  period_s?: number;
  signals?: string[];
  stock: { from: number[]; to: number[] } | null;
  is_lathe?: boolean;
  overrides: { feed: Range; rapid: Range; spindle: Range };
}

export type Verdict = 'good' | 'failed' | 'not_judged';
export interface Feature {
  line: number;
  kind: string;
  verdict: Verdict;
  reason: string | null;
  tool: number | null;
  time_s: number;
  position: number[] | null;
  [measure: string]: unknown;
}
export interface Segment { line: number; kind: string; points: number[][] }
export interface Hole { line: number; kind: string; at: number[]; bottom?: number }
export interface Program { name: string; text: string; segments: Segment[]; holes: Hole[] }

export interface Tool {
  number: number;
  description: string;
  kind: string;
  length_mm: number;
  diameter_mm: number | null;
  wear_length_mm: number;
  wear_radius_mm: number;
}
export interface WorkOffset { work_offset: string; is_active: boolean; axes: Record<string, number> }
