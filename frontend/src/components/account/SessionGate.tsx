import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect, type ReactNode } from "react";
import { setAccountName } from "../../api/analyst";
import { LOGGED_OUT } from "../../api/client";
import { sessionQuery } from "../../api/queries";
import { InvitationForm, LoginForm, ProviderLogin } from "./LoginForm";

/** Shows the workbench to whoever may use it, and the log-in to others. */
export function SessionGate({ children }: { children: ReactNode }) {
  const cache = useQueryClient();
  const session = useQuery(sessionQuery);
  useEffect(() => {
    const ask = () => {
      void cache.invalidateQueries({ queryKey: sessionQuery.queryKey });
    };
    window.addEventListener(LOGGED_OUT, ask);
    return () => {
      window.removeEventListener(LOGGED_OUT, ask);
    };
  }, [cache]);
  const { data } = session;
  useEffect(() => {
    setAccountName(data === undefined || data.mode === "personal" ? null : data.name);
  }, [data]);

  if (session.isPending) return null;
  // A lost connection is reported by the frame.
  if (data === undefined || data.mode === "personal" || data.name !== null) return children;
  if (data.mode === "team" && window.location.pathname === "/invitation") {
    return <InvitationForm />;
  }
  return data.has_provider ? <ProviderLogin /> : <LoginForm byPassword={data.mode === "team"} />;
}
