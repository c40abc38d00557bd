// The shown frame and the chosen object, as encoded behind `#` in the page's address.

const kQuiet_ms = 250;  // browsers refuse addresses that change with every frame

const here = () => new URLSearchParams(location.hash.slice(1));

function whole(text) { return /^\d{1,12}$/.test(text ?? "") ? Number(text) : null; }

export function readLink() { return { frame: whole(here().get("frame")), object: whole(here().get("object")) }; }

// The printed address has a token behind `#`, which browsers do not transmit. It is kept for this tab and removed from
// the address, so that a shared link cannot hold the run.
export function takeToken() {
  const params = here(), token = params.get("token");
  try {
    if (token) sessionStorage.setItem("token", token);
    if (token) {
      params.delete("token");
      history.replaceState(null, "", `${location.pathname}${params.size > 0 ? `#${params}` : ""}`);
    }
    return token || sessionStorage.getItem("token") || "";
  } catch { return token || ""; }
}

// Calls `onGo(link)` when the address is changed by hand, or by going back and forward.
export class FrameLink {
  constructor(onGo) {
    this.due = 0;
    window.addEventListener("hashchange", () => {
      const link = readLink();
      if (link.frame !== null) onGo(link);
    });
  }

  text(frame, object) { return `#frame=${frame}${object === null ? "" : `&object=${object}`}`; }

  // A jump gets an entry in the history; steps replace the address, once they pause.
  write(frame, object, jump = false) {
    clearTimeout(this.due);
    const text = this.text(frame, object);
    if (jump && location.hash !== text) history.pushState(null, "", text);
    else if (!jump) this.due = setTimeout(() => { if (location.hash !== text) history.replaceState(null, "", text); }, kQuiet_ms);
  }

  async copy(frame, object) {
    const text = new URL(this.text(frame, object), location.href).href;
    try {
      await navigator.clipboard.writeText(text);
    } catch {  // fails where the page is served to other machines without encryption
      const field = document.createElement("textarea");
      field.value = text;
      document.body.append(field);
      field.select();
      document.execCommand("copy");
      field.remove();
    }
  }
}
