// A record as MCAP, as `leadscrew trace convert` writes it: a message of leadscrew.Period for each period, in Protocol Buffers with its
// descriptor; `X.setpoint_mm` is the field X_setpoint_mm, its unit stands in the metadata. What has no value in a period is NaN.
import { BinaryWriter, WireType } from '@bufbuild/protobuf/wire';
import { McapWriter } from '@mcap/core';
import type { SampleRecord } from './record';
import { unitOf } from './unit';

const ns = 1e9;
const topic = 'trace';
const [inPackage, name] = ['leadscrew', 'Period'];

/** Grows as it is written to. */
class Memory {
  #parts: Uint8Array[] = [];
  #bytes = 0n;
  position(): bigint { return this.#bytes; }
  write(part: Uint8Array): Promise<void> {
    this.#parts.push(part.slice());
    this.#bytes += BigInt(part.byteLength);
    return Promise.resolve();
  }
  blob(): Blob { return new Blob(this.#parts as BlobPart[]); }
}

/** Names of fields have letters, digits and `_` alone, and begin with a letter. */
const fieldOf = (column: string): string => column.replace(/[^A-Za-z0-9]/g, '_').replace(/^(?![A-Za-z])/, 'f');

/** A FileDescriptorSet, after descriptor.proto: `double` is type 1, `optional` label 1. */
function descriptorOf(columns: string[]): Uint8Array {
  const set = new BinaryWriter();
  set.tag(1, WireType.LengthDelimited).fork();
  set.tag(1, WireType.LengthDelimited).string('leadscrew.proto');
  set.tag(2, WireType.LengthDelimited).string(inPackage);
  set.tag(4, WireType.LengthDelimited).fork();
  set.tag(1, WireType.LengthDelimited).string(name);
  columns.forEach((column, index) => {
    set.tag(2, WireType.LengthDelimited).fork();
    set.tag(1, WireType.LengthDelimited).string(fieldOf(column));
    for (const [field, value] of [[3, index + 1], [4, 1], [5, 1]] as const) set.tag(field, WireType.Varint).uint32(value);
    set.join();
  });
  set.join();
  set.tag(12, WireType.LengthDelimited).string('proto3');
  return set.join().finish();
}

export async function mcapOf(record: SampleRecord, conditions: Record<string, string>): Promise<Blob> {
  const [memory, names] = [new Memory(), ['time_s', ...record.signals]];
  const about = new Map([...Object.entries(conditions), ...names.map((column): [string, string] => [`unit:${column}`, unitOf(column)])]);
  const writer = new McapWriter({ writable: memory });
  await writer.start({ profile: '', library: 'leadscrew' });
  const schemaId = await writer.registerSchema({ name: `${inPackage}.${name}`, encoding: 'protobuf', data: descriptorOf(names) });
  const channelId = await writer.registerChannel({ schemaId, topic, messageEncoding: 'protobuf', metadata: about });
  await writer.addMetadata({ name: topic, metadata: about });
  const columns = record.signals.map((_, index) => record.column(index));
  for (let row = 0; row < record.rows; row++) {
    const time_s = record.start_s + row * record.period_s;
    const message = new BinaryWriter().tag(1, WireType.Bit64).double(time_s);
    columns.forEach((column, index) => message.tag(index + 2, WireType.Bit64).double(column[row] ?? NaN));
    const time = BigInt(Math.round(time_s * ns));
    await writer.addMessage({ channelId, sequence: row, publishTime: time, logTime: time, data: message.finish() });
  }
  await writer.end();
  return memory.blob();
}
