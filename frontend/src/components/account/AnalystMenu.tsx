import { Button, Popover, Stack, Text, TextInput, UnstyledButton } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { setAnalystName, useAnalyst } from "../../api/analyst";
import { sessionQuery } from "../../api/queries";
import { AccountMenu } from "./AccountMenu";

/** The account, or without accounts the name shown with comments and votes. */
export function AnalystMenu() {
  const { data } = useQuery(sessionQuery);
  if (data !== undefined && data.mode !== "personal") return <AccountMenu session={data} />;
  return <NameMenu />;
}

function NameMenu() {
  const name = useAnalyst();
  const [open, setOpen] = useState(false);
  return (
    <Popover opened={open} onChange={setOpen} position="bottom-end" trapFocus returnFocus>
      <Popover.Target>
        <UnstyledButton
          className="frame-find"
          data-testid="analyst"
          aria-label={name === "" ? "Set your name" : `Working as ${name}`}
          onClick={() => {
            setOpen(!open);
          }}
        >
          {name === "" ? "Your name" : name}
        </UnstyledButton>
      </Popover.Target>
      <Popover.Dropdown>
        <NameForm
          onDone={() => {
            setOpen(false);
          }}
        />
      </Popover.Dropdown>
    </Popover>
  );
}

export function NameForm({ onDone }: { onDone?: () => void }) {
  const name = useAnalyst();
  const [typed, setTyped] = useState(name);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        setAnalystName(typed);
        onDone?.();
      }}
    >
      <Stack gap="xs" w={260}>
        <TextInput
          label="Your name"
          data-autofocus
          data-testid="analyst-name"
          maxLength={100}
          value={typed}
          onChange={(event) => {
            setTyped(event.currentTarget.value);
          }}
        />
        <Text size="xs" className="quiet">
          Shown as unverified with your proposals, comments and votes: there are no accounts. Stored
          in this browser.
        </Text>
        <Button type="submit" data-testid="analyst-save">
          {" "}
          Save{" "}
        </Button>
      </Stack>
    </form>
  );
}
