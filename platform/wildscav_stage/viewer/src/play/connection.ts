// The WebSocket to the server: messages as JSON both ways. A lost one is opened again.

import type { Message } from "./messages";

export const RENEWED = 4002; // close code: the link has ended
export const WHY_RENEWED = "The host has made a new link for this seat. Ask the host for it.";
const ENDED = 4000; // close codes from here on are the server's decisions, after which nothing is tried again
const REFUSED = [1003, 1008, 1009]; // likewise: the page sent what it must not
const FIRST_WAIT = 500; // ms before the first new try; each further one waits longer
const LONGEST_WAIT = 4000; // ms
const PATIENCE = 90_000; // ms, after which nothing is tried again

export interface Listener {
  receive(message: Message): void;
  lose(): void; // the connection is lost, and tried again
  close(code: number, reason: string): void; // it is not
}

export class Connection {
  private socket!: WebSocket;
  private lostAt: number | null = null;
  private wait = FIRST_WAIT;

  constructor(private readonly listener: Listener) {
    this.open();
  }

  open(): void {
    const address = new URL(`${location.pathname}/socket`, location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(address);
    this.socket.onopen = () => {
      this.lostAt = null;
    };
    this.socket.onclose = ({ code, reason }) => this.closed(code, reason);
    this.socket.onmessage = ({ data }) => {
      const message = JSON.parse(data) as Message;
      if ("number" in message) this.send({ kind: "seen", number: message.number });
      this.listener.receive(message);
    };
  }

  send(message: object): void {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private closed(code: number, reason: string): void {
    const now = performance.now();
    if (this.lostAt === null) [this.lostAt, this.wait] = [now, FIRST_WAIT];
    if (code >= ENDED || REFUSED.includes(code) || now - this.lostAt > PATIENCE) {
      this.lostAt = null;
      this.listener.close(code, reason);
      return;
    }
    this.listener.lose();
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(LONGEST_WAIT, 1.6 * this.wait);
  }
}
