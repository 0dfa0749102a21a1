// A record as MCAP: a message of JSON for each period, whose schema names the unit of each signal; `X.setpoint_mm` is the field
// setpoint_mm of X. What has no value in a period is not in its message.
import { McapWriter } from '@mcap/core';
import type { SampleRecord } from './record';
import { unitOf } from './unit';

const ns = 1e9;

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

type Fields = Record<string, unknown>;
const placed = (into: Fields, name: string, value: unknown, branch: () => Fields): void => {
  const at = name.indexOf('.');
  if (at < 0) { into[name] = value; return; }
  const key = name.slice(0, at);
  placed((into[key] ??= branch()) as Fields, name.slice(at + 1), value, branch);
};

function schemaOf(signals: string[]): Fields {
  const schema: Fields = { type: 'object', properties: {} };
  for (const name of signals) {
    const path = name.split('.');
    let at = schema.properties as Record<string, Fields>;
    for (const part of path.slice(0, -1)) at = (at[part] ??= { type: 'object', properties: {} }).properties as Record<string, Fields>;
    at[path.at(-1) ?? name] = { type: 'number', description: `unit: ${unitOf(name)}` };
  }
  return schema;
}

export async function mcapOf(record: SampleRecord, conditions: Record<string, string>): Promise<Blob> {
  const [memory, text] = [new Memory(), new TextEncoder()];
  const writer = new McapWriter({ writable: memory });
  await writer.start({ profile: '', library: 'leadscrew' });
  const schemaId = await writer.registerSchema({ name: 'Scope', encoding: 'jsonschema', data: text.encode(JSON.stringify(schemaOf(['time_s', ...record.signals]))) });
  const channelId = await writer.registerChannel({ schemaId, topic: 'scope', messageEncoding: 'json', metadata: new Map(Object.entries(conditions)) });
  const columns = record.signals.map((_, index) => record.column(index));
  for (let row = 0; row < record.rows; row++) {
    const time_s = record.start_s + row * record.period_s;
    const message: Fields = { time_s };
    columns.forEach((column, index) => {
      const value = column[row] ?? NaN;
      if (!Number.isNaN(value)) placed(message, record.signals[index] ?? '', value, () => ({}));
    });
    const time = BigInt(Math.round(time_s * ns));
    await writer.addMessage({ channelId, sequence: row, publishTime: time, logTime: time, data: text.encode(JSON.stringify(message)) });
  }
  await writer.end();
  return memory.blob();
}
