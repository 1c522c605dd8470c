rigcal_test(webhook_test SOURCES unit/webhook/post_test.cc DEPS rigcal_webhook)
