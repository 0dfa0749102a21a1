// The types of the API as the page uses them: those that are generated from the control, with the words of its enumerations.
import type * as Api from '../api/types';

export type Unit = 'mm' | 'deg';
export type Execution =
  | 'READY' | 'ACTIVE' | 'WAIT' | 'FEED_HOLD' | 'INTERRUPTED' | 'OPTIONAL_STOP'
  | 'PROGRAM_STOPPED' | 'PROGRAM_COMPLETED' | 'STOPPED';
export type Verdict = 'good' | 'failed' | 'not_judged';

export type AxisStatus = Omit<Api.AxisStatus, 'unit'> & { unit: Unit };
export type Status = Omit<Api.Status, 'execution' | 'axes' | 'emergency_stop'> & {
  execution: Execution;
  axes: AxisStatus[];
  emergency_stop: 'ARMED' | 'TRIGGERED';
};
export type MachineAxis = Omit<Api.MachineAxis, 'unit'> & { unit: Unit };
export type Machine = Omit<Api.MachineBody, 'axes'> & { axes: MachineAxis[] };
export type Run = Omit<Api.RunBody, 'verdict'> & { verdict: Verdict };
export type Runs = Omit<Api.RunsBody, 'runs'> & { runs: Run[] };
export type RunDetail = Omit<Api.RunDetailBody, 'run' | 'features'> & { run: Run; features: Feature[] };
export type RunTrace = Api.RunTraceBody;
export type Feature = Omit<Api.FeatureBody, 'verdict'> & { verdict: Verdict };
export type { AlarmBody as Alarm, FindingData as Finding, HoleBody as Hole, OffsetBody as WorkOffset } from '../api/types';
export type { ProgramBody as Program, RequestBody, SegmentBody as Segment, ToolBody as Tool } from '../api/types';
