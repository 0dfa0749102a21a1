// A record as Parquet: the time in f64, each signal in f32, the conditions and the unit of each column in the file's metadata.
import { parquetWriteBuffer } from 'hyparquet-writer';
import type { SampleRecord } from './record';
import { unitOf } from './unit';

export function parquetOf(record: SampleRecord, conditions: Record<string, string>): ArrayBuffer {
  const times = Float64Array.from({ length: record.rows }, (_, row) => record.start_s + row * record.period_s);
  const units = Object.fromEntries(['time_s', ...record.signals].map((name) => [`unit:${name}`, unitOf(name)]));
  return parquetWriteBuffer({
    columnData: [
      { name: 'time_s', data: times, type: 'DOUBLE' },
      ...record.signals.map((name, index) => ({ name, data: record.column(index), type: 'FLOAT' as const })),
    ],
    kvMetadata: Object.entries({ ...conditions, ...units }).map(([key, value]) => ({ key, value })),
  });
}
