// Why a key cannot be used now. The control decides; this table, which is that of its requests, only lets a key say so
// before it is asked. What the control refuses all the same is shown with its own words.
import { needs as say } from '../texts/en';
import type { Execution, Status } from './model';

const underWay: Execution[] = ['ACTIVE', 'WAIT', 'FEED_HOLD', 'INTERRUPTED', 'OPTIONAL_STOP', 'PROGRAM_STOPPED'];
const held: Execution[] = ['FEED_HOLD', 'INTERRUPTED'];
const stopped: Execution[] = ['OPTIONAL_STOP', 'PROGRAM_STOPPED'];

export const isUnderWay = (status: Status) => underWay.includes(status.execution);
export const isHeld = (status: Status) => held.includes(status.execution);
export const waitsForConfirmation = (status: Status) => stopped.includes(status.execution);

type Need = Exclude<keyof typeof say, 'link'>;

function isMet(need: Need, status: Status): boolean {
  switch (need) {
    case 'emergencyStopArmed': return status.emergency_stop === 'ARMED';
    case 'emergencyStopTriggered': return status.emergency_stop === 'TRIGGERED';
    case 'noAlarm': return status.alarms.length === 0;
    case 'powerOn': return status.power === 'ON' && status.is_ready;
    case 'homed': return status.axes.every((axis) => axis.is_homed);
    case 'noProgramUnderWay': return !isUnderWay(status);
    case 'programUnderWay': return isUnderWay(status);
    case 'programHeld': return isHeld(status);
    case 'programWaits': return waitsForConfirmation(status);
    case 'programLoaded': return status.program !== null;
    case 'toolInWork': return status.is_tool_in_work;
    case 'noToolInWork': return !status.is_tool_in_work || isUnderWay(status);
  }
}

const moving: Need[] = ['emergencyStopArmed', 'noAlarm', 'powerOn', 'noProgramUnderWay', 'noToolInWork'];
const needsOf: Record<string, Need[]> = {
  power_on: ['emergencyStopArmed', 'noAlarm'],
  power_off: ['noProgramUnderWay', 'noToolInWork'],
  home: moving,
  jog: moving,
  turn_spindle: moving,
  load: ['noProgramUnderWay'],
  start: ['programLoaded', ...moving, 'homed'],
  manual_data_input: [...moving, 'homed'],
  feed_hold: ['programUnderWay', 'noAlarm'],
  resume: ['programUnderWay', 'noAlarm', 'programHeld'],
  confirm: ['programUnderWay', 'noAlarm', 'programWaits'],
  stop: ['programUnderWay'],
  reset: ['emergencyStopArmed', 'noProgramUnderWay', 'noToolInWork'],
  touch_off: ['noProgramUnderWay', 'homed'],
  set_work_offset: ['noProgramUnderWay'],
  edit_tool: ['noProgramUnderWay'],
  block_skip: ['noProgramUnderWay'],
  retract: ['toolInWork'],
  recover: ['toolInWork'],
};

/** The reason why `key` cannot be used, or null: the first of its needs that is not met. */
export function whyNot(key: string, status: Status | null, isLinked: boolean): string | null {
  if (!isLinked || !status) return say.link;
  const needs = needsOf[key] ?? [];
  const missing = needs.find((need) => !isMet(need, status));
  if (!missing) return null;
  if (missing === 'homed') return say.homed(status.axes.find((axis) => !axis.is_homed)?.letter ?? '');
  return say[missing] as string;
}

