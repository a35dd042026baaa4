// The WebSocket to the server: messages as JSON both ways, and pictures from it. A lost one is opened again.

const DECODER = new TextDecoder();
const ENDED = 4000; // close codes from here on are the server's decisions, after which nothing is tried again
const REFUSED = [1003, 1008, 1009]; // likewise: the page sent what it must not
const FIRST_WAIT = 500; // ms before the first new try; each further one waits longer
const LONGEST_WAIT = 4000; // ms
const PATIENCE = 90_000; // ms, after which nothing is tried again

export class Connection {
  // onMessage gets each message; onPicture gets what is shown beside a picture, and the picture as a Blob.
  // onLost is called when the connection is lost and tried again; onClose when it is not.
  constructor({ onMessage, onPicture, onLost, onClose }) {
    Object.assign(this, { onMessage, onPicture, onLost, onClose });
    this.lostAt = null;
    this.open();
  }

  open() {
    const address = new URL(`${location.pathname}/socket`, location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => { this.lostAt = null; };
    this.socket.onclose = ({ code, reason }) => this.#closed(code, reason);
    this.socket.onmessage = ({ data }) => {
      if (typeof data === "string") return this.onMessage(JSON.parse(data));
      const length = new DataView(data).getUint32(0, true);
      const head = JSON.parse(DECODER.decode(new Uint8Array(data, 4, length)));
      return this.onPicture(head, new Blob([new Uint8Array(data, 4 + length)], { type: "image/jpeg" }));
    };
  }

  #closed(code, reason) {
    const now = performance.now();
    if (this.lostAt === null) [this.lostAt, this.wait] = [now, FIRST_WAIT];
    if (code >= ENDED || REFUSED.includes(code) || now - this.lostAt > PATIENCE) {
      this.lostAt = null;
      this.onClose(code, reason);
      return;
    }
    this.onLost();
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(LONGEST_WAIT, 1.6 * this.wait);
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}
