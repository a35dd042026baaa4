// Server-sent events, of which the news of a match that is being played come.

export interface StreamEvent {
  id: string; // empty if it has none
  kind: string;
  data: string;
}

export class EventReader {
  private rest = "";
  private readonly decoder = new TextDecoder();

  // Read the next bytes of a stream; returns the events that are complete.
  read(bytes: Uint8Array): StreamEvent[] {
    const blocks = (this.rest + this.decoder.decode(bytes, { stream: true })).split("\n\n");
    this.rest = blocks.pop() ?? "";
    return blocks.map(eventOf).filter(({ kind }) => kind);
  }
}

function eventOf(block: string): StreamEvent {
  const fields = new Map(
    block.split("\n").map((line): [string, string] => {
      const colon = line.indexOf(": ");
      return [line.slice(0, colon), line.slice(colon + 2)];
    }),
  );
  return { id: fields.get("id") ?? "", kind: fields.get("event") ?? "", data: fields.get("data") ?? "" };
}
