import { Button, CloseButton, Text } from "@mantine/core";
import { notify, useNotice } from "../../lib/notice";

/** What was just done, and undo. */
export function NoticeBar() {
  const notice = useNotice();
  return (
    <div role="status" aria-live="polite" className="notice-place no-print">
      {notice !== null && (
        <div className="notice" data-testid="notice">
          <Text size="sm">{notice.text}</Text>
          {notice.undo !== undefined && (
            <Button
              variant="default"
              data-testid="undo"
              onClick={() => {
                notify(null);
                notice.undo?.();
              }}
            >
              Undo
            </Button>
          )}
          <CloseButton
            aria-label="Close this notice"
            onClick={() => {
              notify(null);
            }}
          />
        </div>
      )}
    </div>
  );
}
