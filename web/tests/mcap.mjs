// MCAP as Foxglove reads it: by its own libraries, which make the decoder of the descriptor in the file.
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from '@mcap/support';
import { McapIndexedReader } from '@mcap/core';

/** The channel's metadata, and each message with its time: `log_ns` and its fields. */
export async function readMcap(bytes) {
  const readable = { size: () => Promise.resolve(BigInt(bytes.length)), read: (at, size) => Promise.resolve(new Uint8Array(bytes.subarray(Number(at), Number(at + size)))) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: await loadDecompressHandlers() });
  const [[schema], [channel]] = [[...reader.schemasById.values()], [...reader.channelsById.values()]];
  if (schema.encoding !== 'protobuf' || channel.messageEncoding !== 'protobuf') throw new Error(`${schema.encoding}, ${channel.messageEncoding}`);
  const type = protobufFromBinaryDescriptor(schema.data).lookupType(schema.name);
  const rows = [];
  for await (const message of reader.readMessages()) {
    const read = type.decode(message.data);
    rows.push({ log_ns: message.logTime, ...Object.fromEntries(type.fieldsArray.map(({ name }) => [name, read[name]])) });
  }
  return { about: channel.metadata, rows };
}
