{{%AUTOESCAPE context="HTML"}}
<section class="banner {{LEVEL}}" aria-label="Verdict">
<svg class="icon" viewBox="0 0 24 24" aria-hidden="true"><path d="{{ICON}}"/></svg>
<div>
<p class="word">{{WORD}}</p>
<p class="why" dir="auto">{{WHY}}</p>
{{#DO}}<p class="do" dir="auto"><strong>What to do:</strong> {{WHAT_TO_DO}}</p>{{/DO}}
</div>
</section>
