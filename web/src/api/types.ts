// Types of the API, written by a test of `crates/server` from the Rust types. Do not edit:
// UPDATE_API=1 cargo test -p server --test all types::

export type Status = { 
/**
 * Machine time, s.
 */
time_s: number, 
/**
 * The emergency stop chain: `ARMED`, `TRIGGERED`.
 */
emergency_stop: string, 
/**
 * The drives: `OFF`, `ON`.
 */
power: string, 
/**
 * The drives are up, and nothing has stopped the machine.
 */
is_ready: boolean, 
/**
 * `AUTOMATIC`, `MANUAL_DATA_INPUT`, `MANUAL`.
 */
mode: string, 
/**
 * What the program does.
 */
execution: string, 
/**
 * What the axes do.
 */
activity: string, 
/**
 * What it waits for, since when, and for how long at most.
 */
waiting_for: WaitingStatus | null, 
/**
 * The axes, X first.
 */
axes: Array<AxisStatus>, 
/**
 * The spindles.
 */
spindles: Array<SpindleStatus>, 
/**
 * Tool in the spindle; `None` while it is changed, 0 is none.
 */
tool: number | null, 
/**
 * The work offset in force.
 */
work_offset: string, 
/**
 * Codes in force at the block that is executed; none are known of a program that asks the
 * machine something.
 */
codes: Array<string>, 
/**
 * Coolant flows: flood.
 */
flood: boolean, 
/**
 * The same: mist.
 */
mist: boolean, 
/**
 * Speed of the path of X, Y and Z as it is ordered, mm/min, over 20 ms.
 */
path_mm_per_min: number, 
/**
 * Overrides.
 */
overrides: Overrides, 
/**
 * Single block, optional stop, block skip.
 */
switches: Switches, 
/**
 * The program.
 */
program: ProgramStatus | null, 
/**
 * What is being read for a request that is not answered yet.
 */
loading?: LoadingStatus, 
/**
 * Distance of the follower from its coupling, while one is engaged in the material, µm.
 */
sync_error_um: number | null, 
/**
 * A tool that is tied to a spindle is in the work.
 */
is_tool_in_work: boolean, 
/**
 * What is known of it, where a control before this one has left it there.
 */
left_in_work?: LeftInWork, 
/**
 * The tool change that is under way or was left half way, where a sequence works it.
 */
sequence?: SequenceStatus, 
/**
 * Where the tools are, where a sequence works the changer.
 */
magazine?: MagazineStatus, 
/**
 * What the program has said last to the operator, since it was started.
 */
message?: MessageStatus, 
/**
 * Features of the workpiece, over all programs that were started on it.
 */
features: FeatureCount, 
/**
 * The workpiece.
 */
workpiece: WorkpieceStatus, 
/**
 * Alarms that no reset has cleared.
 */
alarms: Array<string>, 
/**
 * What is in force and is not what the control wrote last: until it is acknowledged, no
 * program, no blocks and no homing are started.
 */
state_changes?: Array<StateChangeStatus>, 
/**
 * What requests may need and is not so now.
 */
unmet: Array<NeedStatus>, 
/**
 * How the servo thread keeps its time, in real time.
 */
real_time?: RealTimeFigures, };

export type RealTimeFigures = { 
/**
 * Servo periods so far.
 */
periods: number, 
/**
 * Of these, begun later than a whole period after they were due.
 */
late: number, 
/**
 * The latest, µs after it was due.
 */
worst_late_us: number, 
/**
 * So late that the clock was set anew.
 */
set_anew: number, 
/**
 * Periods that no observer has seen, because the observers did not keep up.
 */
unobserved: number, 
/**
 * Median of the kernel's tick, µs.
 */
tick_median_us: number, 
/**
 * 99.9 of 100 ticks are shorter, µs.
 */
tick_p999_us: number, 
/**
 * The longest tick, µs.
 */
tick_worst_us: number, };

export type AxisStatus = { 
/**
 * Its letter.
 */
letter: string, 
/**
 * What its coordinates are measured in: `mm` or `deg`.
 */
unit: string, 
/**
 * Setpoint in machine coordinates.
 */
machine: number, 
/**
 * The tool's tip in the work offset in force.
 */
work: number, 
/**
 * Way to where the operation that is executed leads it, of a tap to its bottom; `None`: no
 * program moves it.
 */
to_go: number | null, 
/**
 * It is homed.
 */
is_homed: boolean, 
/**
 * Setpoint less position by its encoder.
 */
following_error: number, 
/**
 * Force that its drive measures, in percent of what it can hold for ever, over 20 ms; `None`:
 * it does not measure it, or the machine's file does not say what it can hold.
 */
load_percent: number | null, 
/**
 * How warm its drive is by its load, in percent of what it bears for ever.
 */
thermal_percent: number | null, };

export type SpindleStatus = { 
/**
 * Speed that it is ordered to have, rev/min; positive is M3.
 */
ordered_rpm: number, 
/**
 * Speed by its encoder, rev/min, over 20 ms; positive is M3.
 */
measured_rpm: number, 
/**
 * Torque that its drive measures, else the torque commanded, N·m without its sign, over 20 ms;
 * `None`: its drive is commanded by speed, and does not say its torque.
 */
torque_n_m: number | null, 
/**
 * The same in percent of what the drive can hold for ever at this speed.
 */
load_percent: number | null, 
/**
 * How warm its drive is by its load, in percent of what it bears for ever.
 */
thermal_percent: number | null, 
/**
 * Angle within its turn, degrees.
 */
angle_deg: number, };

export type Overrides = { 
/**
 * Percent of the programmed feed.
 */
feed_percent: number, 
/**
 * Percent of the rapids.
 */
rapid_percent: number, 
/**
 * Percent of the programmed spindle speed.
 */
spindle_percent: number, 
/**
 * A synchronised cut locks them now.
 */
is_locked: boolean, };

export type Switches = { 
/**
 * Hold after each block.
 */
single_block: boolean, 
/**
 * Stop at M1.
 */
optional_stop: boolean, 
/**
 * Levels of `/`, 1 to 9, whose blocks the next start leaves out.
 */
block_skip: Array<number>, };

export type NeedStatus = { 
/**
 * Its name, as `GET machine` has it with the requests that need it.
 */
need: string, 
/**
 * Why such a request is refused now.
 */
reason: string, 
/**
 * What would make it possible, where the reason does not say it.
 */
remedy: string | null, };

export type WaitingStatus = { 
/**
 * For what.
 */
what: string, 
/**
 * For how long it has lasted, s.
 */
age_s: number, 
/**
 * How long it may last, s; `None`: as long as it takes.
 */
limit_s: number | null, };

export type ProgramStatus = { 
/**
 * Its name; `MDI` of what was typed.
 */
name: string, 
/**
 * The line that is executed; 0 is none.
 */
line: number, 
/**
 * How long it is planned to take, s; `None`: a long program whose time is still being planned.
 */
planned_s: number | null, 
/**
 * For how long it has been under way, s.
 */
elapsed_s: number, 
/**
 * Planned time, at overrides of 100 %, of what is still to be done, s; `None`: as above.
 */
left_s: number | null, 
/**
 * How long what is planned, and waits to be executed, will take, s; what has no planned time
 * counts nothing.
 */
ahead_s: number, };

export type LeftInWork = { 
/**
 * The tool, by the record.
 */
tool: number | null, 
/**
 * The program that led it there …
 */
program: string | null, 
/**
 * … the line …
 */
line: number | null, 
/**
 * … and which of its holes and threads it is, counted from 1.
 */
hole: number | null, 
/**
 * How far the tip of a tap stands below the surface, mm; below zero it is above.
 */
depth_mm: number | null, 
/**
 * How far the program led it, mm below the surface.
 */
programmed_depth_mm: number | null, 
/**
 * How far it stands off its thread, µm …
 */
off_thread_um: number | null, 
/**
 * … and what that is certain to.
 */
within_um: number | null, 
/**
 * On what the certainty rests, or why there is none.
 */
certain_by: string | null, 
/**
 * What moves first, in a sentence.
 */
moves_first: string | null, 
/**
 * Why it may be broken.
 */
not_known_whole: string | null, 
/**
 * Why no recovery takes it out; `null`: `recover` does.
 */
refused: string | null, };

export type SequenceStatus = { 
/**
 * Its name.
 */
name: string, 
/**
 * Name of the step that was begun last.
 */
step: string, 
/**
 * Its number, from 1.
 */
number: number, 
/**
 * Number of steps of the sequence.
 */
of: number, 
/**
 * It is, or was, being undone.
 */
is_back: boolean, 
/**
 * Nothing leads it on: that is for the operator.
 */
is_half_way: boolean, 
/**
 * Only a person undoes this step.
 */
is_undone_by_hand: boolean, 
/**
 * Tool in the spindle at its beginning; 0 is none.
 */
from: number, 
/**
 * Tool in the spindle at its end; 0 is none.
 */
to: number, 
/**
 * What the step tells the operator to do.
 */
operator: string | null, 
/**
 * Inputs as they are, and as they should be once the step is done.
 */
inputs: Array<SequenceInput>, };

export type SequenceInput = { 
/**
 * Its name.
 */
name: string, 
/**
 * It is on.
 */
is: boolean, 
/**
 * It should be on.
 */
should_be: boolean, };

export type MagazineStatus = { 
/**
 * Tool in each pocket, pocket 1 first; 0 is none.
 */
pockets: Array<number>, 
/**
 * Tool in the spindle; 0 is none.
 */
spindle: number, 
/**
 * Pocket at the spindle; `None`: not known.
 */
at: number | null, };

export type MessageStatus = { 
/**
 * The message.
 */
text: string, 
/**
 * Its line.
 */
line: number, 
/**
 * Machine time at which it was heard, s.
 */
time_s: number, };

export type LoadingStatus = { 
/**
 * Its name; `MDI` of what was typed.
 */
name: string, 
/**
 * How much of it is done, percent.
 */
percent: number, };

export type StateChangeStatus = { 
/**
 * Its name: `G54 X`, `tool 3 length_mm`; or the file, where nothing more is known.
 */
datum: string, 
/**
 * As the control wrote it last.
 */
before: string, 
/**
 * As it is in force.
 */
now: string, 
/**
 * Which copy is in force, from when, and why.
 */
why: string, };

export type WorkpieceStatus = { 
/**
 * Its number on this machine, from 1.
 */
number: number, 
/**
 * Its name; `null`: it has none.
 */
name: string | null, 
/**
 * Programs that were started on it.
 */
programs: number, 
/**
 * It has ended: the next start begins another one.
 */
is_ended: boolean, 
/**
 * Features of it that are counted and no longer listed.
 */
unlisted: number, };

export type FeatureCount = { 
/**
 * Within tolerance.
 */
good: number, 
/**
 * Out of it.
 */
failed: number, 
/**
 * Not judged.
 */
not_judged: number, };

export type RequestBody = { "request": "power", on: boolean, } | { "request": "emergency_stop", on: boolean, } | { "request": "home", axis?: string, } | { "request": "jog_continuous", axis: string, mm_per_min?: number, deg_per_min?: number, } | { "request": "jog_increment", axis: string, by_mm?: number, by_deg?: number, } | { "request": "jog_to", axis: string, to_mm?: number, to_deg?: number, } | { "request": "handwheel", axis: string, by_mm?: number, by_deg?: number, } | { "request": "jog_stop", } | { "request": "turn_spindle", spindle: number, rpm: number, } | { "request": "orient_spindle", spindle: number, angle_deg: number, } | { "request": "load", program: string, dialect?: string, } | { "request": "search", line?: number, hole?: number, tool?: number, 
/**
 * Also where the program was changed since it was left half done.
 */
program_changed?: boolean, } | { "request": "start", } | { "request": "manual_data_input", blocks: string, } | { "request": "feed_hold", } | { "request": "resume", } | { "request": "confirm", } | { "request": "stop", } | { "request": "retract", } | { "request": "recover", } | { "request": "tool_is_free", } | { "request": "sequence_go_on", } | { "request": "sequence_undo", } | { "request": "sequence_step", } | { "request": "sequence_step_back", } | { "request": "sequence_done", tool: number, } | { "request": "carousel_is_at", pocket: number, } | { "request": "set_pocket", pocket: number, tool: number, } | { "request": "begin_workpiece", name?: string, } | { "request": "end_workpiece", } | { "request": "acknowledge_state", } | { "request": "reset", } | { "request": "single_block", on: boolean, } | { "request": "optional_stop", on: boolean, } | { "request": "flood", on: boolean, } | { "request": "mist", on: boolean, } | { "request": "block_skip", level: number, on: boolean, } | { "request": "feed_override", percent: number, } | { "request": "rapid_override", percent: number, } | { "request": "spindle_override", percent: number, } | { "request": "touch_off", axis: string, at_mm?: number, at_deg?: number, } | { "request": "set_work_offset", work_offset: string, axis: string, at_mm?: number, at_deg?: number, } | { "request": "edit_tool", tool: number, field: ToolFieldName, value_mm: number, } | { "request": "renew_tool", tool: number, } | { "request": "limit_tool", tool: number, uses: number | null, };

export type ToolFieldName = "length" | "diameter" | "wear_length" | "wear_radius";

export type AcceptedBody = { 
/**
 * True.
 */
accepted: boolean, 
/**
 * What is to be known of it, in sentences.
 */
notes: Array<string>, };

export type RefusalBody = { 
/**
 * False.
 */
accepted: boolean, 
/**
 * Why, in a sentence.
 */
reason: string, 
/**
 * What would make it possible, where the reason does not say it.
 */
remedy: string | null, 
/**
 * Of a program that is refused: what is wrong with it.
 */
findings?: Array<FindingData>, };

export type FindingData = { 
/**
 * Line, from 1; 0: none.
 */
line: number, 
/**
 * Column in bytes, from 1; 0 in a file that the program draws in.
 */
column: number, 
/**
 * Its code in the list of diagnostics.
 */
code: string, 
/**
 * `error`, `warning`, `note`.
 */
severity: string, 
/**
 * The sentence.
 */
message: string, 
/**
 * What to do, if that is known.
 */
help: string | null, };

export type EventBody = { 
/**
 * Its number.
 */
id: number, 
/**
 * Machine time.
 */
time_s: number, 
/**
 * `execution`, `mode`, `drives_ready`, `alarm`, `notice`, `feature`.
 */
event: string, 
/**
 * What the program does now.
 */
execution?: string, 
/**
 * What leads the axes now.
 */
mode?: string, 
/**
 * What has stopped the machine.
 */
alarm?: AlarmBody, 
/**
 * A sentence: of a notice, or of a feature and its verdict.
 */
text?: string, };

export type EventsBody = { 
/**
 * Oldest first.
 */
events: Array<EventBody>, 
/**
 * Number of the last event that there is.
 */
last: number, 
/**
 * How many are no longer kept.
 */
lost: number, };

export type MachineBody = { 
/**
 * Its name.
 */
name: string, 
/**
 * What it is.
 */
description: string, 
/**
 * Its first spindle turns the work, a bar.
 */
is_lathe: boolean, 
/**
 * Servo period.
 */
period_s: number, 
/**
 * Its axes, X first.
 */
axes: Array<MachineAxis>, 
/**
 * Its spindles, the main one first.
 */
spindles: Array<MachineSpindle>, 
/**
 * What its overrides may be turned to.
 */
overrides: OverrideRanges, 
/**
 * The workpiece as it is clamped.
 */
stock: StockBody | null, 
/**
 * Names of the signals that a scope shows.
 */
signals: Array<string>, 
/**
 * What each request needs.
 */
requests: Array<RequestNeeds>, };

export type MachineAxis = { 
/**
 * Its letter.
 */
letter: string, 
/**
 * `linear`, `rotary`.
 */
kind: string, 
/**
 * `mm`, `deg`.
 */
unit: string, 
/**
 * Machine coordinate of one end of its travel.
 */
travel_from: number, 
/**
 * Machine coordinate of the other.
 */
travel_to: number, 
/**
 * Fastest: units per minute.
 */
rapid_per_min: number, 
/**
 * Speed of increments, and the fastest as long as it is not homed: units per minute.
 */
approach_per_min: number, };

export type MachineSpindle = { 
/**
 * Its name.
 */
name: string, 
/**
 * Fastest.
 */
max_rpm: number, };

export type OverrideRanges = { 
/**
 * Of the feed.
 */
feed: OverrideRange, 
/**
 * Of rapids.
 */
rapid: OverrideRange, 
/**
 * Of the spindle's speed.
 */
spindle: OverrideRange, };

export type OverrideRange = { 
/**
 * Least.
 */
least_percent: number, 
/**
 * Most.
 */
most_percent: number, };

export type StockBody = { 
/**
 * What it is made of.
 */
material: string, 
/**
 * Corner at the negative ends, mm.
 */
from: [number, number, number], 
/**
 * Corner at the positive ends, mm; its Z is the surface.
 */
to: [number, number, number], 
/**
 * Diameter of a bore along Z through its middle, mm; 0: it is solid.
 */
bore_mm: number, };

export type RequestNeeds = { 
/**
 * Its name, as in `POST request`.
 */
request: string, 
/**
 * Of one that switches something whose needs differ: which way.
 */
on?: boolean, 
/**
 * Names of what has to be so, in the order in which it is looked at; `unmet` of the status
 * says which is not so now.
 */
needs: Array<string>, };

export type ProgramBody = { 
/**
 * Its path below the folder of programs.
 */
name: string, 
/**
 * Its text.
 */
text: string, 
/**
 * The way of the tool's tip, in the work offset in force when it was loaded.
 */
segments: Array<SegmentBody>, 
/**
 * What is drilled and tapped.
 */
holes: Array<HoleBody>, 
/**
 * The way goes on after these segments.
 */
is_shortened: boolean, };

export type SegmentBody = { 
/**
 * The program's line.
 */
line: number, 
/**
 * `rapid`, `feed`, `tap`, `thread`, `probe`.
 */
kind: string, 
/**
 * Places of the tip: X, Y, Z, mm.
 */
points: Array<[number, number, number]>, };

export type HoleBody = { 
/**
 * The program's line.
 */
line: number, 
/**
 * `hole`, `tap`.
 */
kind: string, 
/**
 * Over it, at the R plane, mm.
 */
at: [number, number, number], 
/**
 * Its programmed depth along Z, mm.
 */
bottom: number, };

export type FolderBody = { 
/**
 * In the order of their paths.
 */
programs: Array<FileBody>, 
/**
 * There are more than are listed.
 */
is_shortened: boolean, };

export type FileBody = { 
/**
 * Below the folder, with `/`.
 */
path: string, 
/**
 * Its size.
 */
bytes: number, 
/**
 * When it was changed, seconds since 1970.
 */
modified_s: number, };

export type SavedBody = { 
/**
 * Below the folder, with `/`.
 */
path: string, 
/**
 * Its size.
 */
bytes: number, 
/**
 * Which version of the program it is: its `ETag`, without the quotes.
 */
version: string, };

export type OffsetBody = { 
/**
 * As a program writes it.
 */
work_offset: string, 
/**
 * It is in force.
 */
is_active: boolean, 
/**
 * Its zero in machine coordinates by axis, mm or degrees.
 */
axes: { [key in string]: number }, };

export type ToolBody = { 
/**
 * T number.
 */
number: number, 
/**
 * For people.
 */
description: string, 
/**
 * `drill`, `spot drill`, `end mill`, `tap`, `polygon cutter`, `hob`, `insert`, `probe`,
 * `other`.
 */
kind: string, 
/**
 * From the gauge line to the tip, without wear.
 */
length_mm: number, 
/**
 * Cutting diameter, without wear.
 */
diameter_mm: number, 
/**
 * Wear of the length, which is added.
 */
wear_length_mm: number, 
/**
 * Wear of the radius, which is added.
 */
wear_radius_mm: number, 
/**
 * How much it has cut, and may.
 */
life: ToolLifeBody, };

export type ToolLifeBody = { 
/**
 * Holes drilled or tapped; other cuts between two tool changes are one together.
 */
uses: number, 
/**
 * At most.
 */
most_uses: number | null, 
/**
 * Time in cutting moves, s.
 */
time_s: number, 
/**
 * At most, s.
 */
most_time_s: number | null, 
/**
 * Length of cutting moves, mm.
 */
cut_mm: number, 
/**
 * At most, mm.
 */
most_cut_mm: number | null, 
/**
 * It broke, and no one has said that a new one is in its place.
 */
is_broken: boolean, 
/**
 * The limit that is reached, in words.
 */
reached: string | null, 
/**
 * A program that takes it at its limit is refused; else it is said.
 */
is_refused_at_limit: boolean, };

export type FeatureBody = { 
/**
 * Number of its operation.
 */
op: number, 
/**
 * The program's line.
 */
line: number, 
/**
 * `hole`, `thread`, `polygon`, `cam`, `turned thread`, `gear`.
 */
kind: string, 
/**
 * The tool that cut it.
 */
tool: number | null, 
/**
 * When it was begun, machine time.
 */
time_s: number, 
/**
 * How long it took.
 */
duration_s: number, 
/**
 * `good`, `failed`, `not_judged`.
 */
verdict: string, 
/**
 * Why it is not good.
 */
reason: string | null, 
/**
 * X and Y of the machine, mm; what is turned about the work's own axis has no place.
 */
position: [number, number] | null, 
/**
 * Depth of a hole; length of full thread.
 */
depth_mm?: number, 
/**
 * Depth less the programmed one.
 */
depth_error_um?: number, 
/**
 * Distance from the programmed place.
 */
position_error_um?: number, 
/**
 * Diameter of a hole.
 */
diameter_mm?: number, 
/**
 * Size of a thread.
 */
size?: string, 
/**
 * Lead of a thread.
 */
lead_mm_per_rev?: number, 
/**
 * Largest sync error in the material.
 */
sync_error_max_um?: number, 
/**
 * Depth of the tip at which that was.
 */
sync_error_depth_mm?: number, 
/**
 * Root of the mean square of it.
 */
sync_error_rms_um?: number, 
/**
 * Finest class whose gauges agree, `none` if not even the coarsest; `not gauged`: there is no
 * full thread.
 */
class?: string, 
/**
 * Class asked.
 */
class_asked?: string, 
/**
 * Distance of the gauge that limits from its limit; negative is out of tolerance.
 */
margin_um?: number, 
/**
 * Which gauge that is.
 */
limiting_gauge?: string, 
/**
 * Pitch diameter of a thread.
 */
pitch_diameter_mm?: number, 
/**
 * Fastest spindle speed in the material.
 */
spin_max_rpm?: number, 
/**
 * Largest torque of the cut.
 */
torque_max_n_m?: number, 
/**
 * The tool was taken out after a stop in the thread.
 */
is_recovered?: boolean, };

export type AlarmBody = { 
/**
 * Number in the alarm list.
 */
number: number, 
/**
 * What has happened.
 */
text: string, 
/**
 * What to do.
 */
remedy: string, 
/**
 * The program that was under way.
 */
program: string | null, 
/**
 * Its line; 0 is none.
 */
line: number, 
/**
 * Machine time.
 */
time_s: number, 
/**
 * A reset has cleared it.
 */
is_cleared: boolean, };

export type RunsBody = { 
/**
 * The latest first.
 */
runs: Array<RunBody>, 
/**
 * There are more.
 */
is_shortened: boolean, 
/**
 * Runs are kept: there is a folder for them.
 */
is_kept: boolean, };

export type RunBody = { 
/**
 * Its id; a later run has a greater one.
 */
id: string, 
/**
 * The program.
 */
program: string, 
/**
 * SHA-256 of its text: runs of the same text have the same.
 */
program_sha256: string, 
/**
 * When it ended, ms since 1970.
 */
ended_unix_ms: number, 
/**
 * How long the machine took, s.
 */
cycle_time_s: number, 
/**
 * The program came to its end.
 */
has_ended: boolean, 
/**
 * The control ended, or was killed, while it was under way: what is known of it was kept as it
 * was cut.
 */
was_cut_off: boolean, 
/**
 * `good`, `failed`, `not_judged`: of the whole run.
 */
verdict: string, 
/**
 * Features that are within tolerance.
 */
good: number, 
/**
 * Features that are out of it.
 */
failed: number, 
/**
 * Features that were not judged.
 */
not_judged: number, 
/**
 * Alarms.
 */
alarms: number, 
/**
 * Its trace is kept.
 */
has_trace: boolean, 
/**
 * Bytes on the disk.
 */
bytes: number, };

export type RunDetailBody = { 
/**
 * What the list says of it.
 */
run: RunBody, 
/**
 * What was cut, as it was judged.
 */
features: Array<FeatureBody>, 
/**
 * What stopped it.
 */
alarms: Array<AlarmBody>, };

export type RunTraceBody = { 
/**
 * Names of all signals of the trace.
 */
available: Array<string>, 
/**
 * Time of the first row, from the run's beginning, s.
 */
from_s: number, 
/**
 * Time of the last row, s.
 */
to_s: number, 
/**
 * Time of each column's first row, s.
 */
time_s: Array<number>, 
/**
 * The signals that were asked for.
 */
signals: Array<RunTraceSignal>, };

export type RunTraceSignal = { 
/**
 * Its name.
 */
name: string, 
/**
 * Least value of each column; null where there is none.
 */
least: Array<number | null>, 
/**
 * Greatest value of each column.
 */
most: Array<number | null>, };

export type SessionOrder = { 
/**
 * As the others see it.
 */
name: string, 
/**
 * Its token, where the server asks for one.
 */
token?: string, };

export type SessionBody = { 
/**
 * Its id, a secret: sent as `x-leadscrew-session`.
 */
session: string, 
/**
 * Its name.
 */
name: string, 
/**
 * `operator`, `viewer`.
 */
role: string, 
/**
 * It has the right to command now.
 */
commands: boolean, };

export type OperatorOrder = { "do": "ask", } | { "do": "grant", } | { "do": "keep", } | { "do": "release", };

export type OperatorBody = { 
/**
 * Name of the session that does.
 */
holder: string | null, 
/**
 * Name of the session that asks for it.
 */
asked_by: string | null, 
/**
 * When it is handed over without an answer.
 */
hands_over_in_s: number | null, };
