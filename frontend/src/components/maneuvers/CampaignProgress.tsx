import { Group, Loader, Text } from "@mantine/core";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useRouter } from "@tanstack/react-router";
import { useEffect } from "react";
import { healthQuery } from "../../api/queries";
import { renew } from "../../api/renew";

/** What the server adds of the demonstration at present; undefined when it is complete. */
function useCampaignProgress(): string | undefined {
  const { data } = useQuery(healthQuery);
  return data?.parts.find(({ name, state }) => name === "demonstration" && state === "starting")
    ?.text;
}

let isOpenedAtStart = window.location.pathname === "/";

/** Opens the first sheet of the demonstration when it exists, if the browser came before it. */
export function useFirstSheet(): void {
  const text = useCampaignProgress();
  const { history } = useRouter();
  useEffect(() => {
    if (text === undefined || !isOpenedAtStart) return;
    fetch("/", { headers: { accept: "text/html" } })
      .then(({ redirected, url }) => {
        if (redirected && isOpenedAtStart) history.replace(new URL(url).pathname);
      })
      .catch(() => undefined); // with the next maneuver again
  }, [text, history]);
  useEffect(
    () => () => {
      isOpenedAtStart = false; // whoever returns to the start page wants to see it
    },
    [],
  );
}

/** Progress of the demonstration campaign while the server adds its maneuvers. */
export function CampaignProgress() {
  const cache = useQueryClient();
  const text = useCampaignProgress();
  useEffect(() => {
    if (text === undefined) return;
    // With every further maneuver the text changes; after the last one it is gone.
    return () => {
      for (const key of ["maneuvers", "flights", "aircraft", "ground-tests"]) {
        void renew(cache, { queryKey: [key] });
      }
    };
  }, [cache, text]);
  if (text === undefined) return null;
  return (
    <Group
      className="panel"
      role="status"
      p="sm"
      mb="md"
      gap="sm"
      wrap="nowrap"
      data-testid="campaign-progress"
    >
      <Loader size="xs" aria-hidden="true" />
      <Text size="sm">{text} Maneuvers can be used as soon as they are listed.</Text>
    </Group>
  );
}
